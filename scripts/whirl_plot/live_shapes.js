// Mode shapes that move: the shaft in space over one turn of the mode, with the orbits of some of its places.
'use strict';
class WhirlShapes {
  constructor(place, data) {
    Object.assign(this, {place, data, mode: 0, angle: 0, yaw: 0.55, pitch: 0.32, visible: true});
    const add = (tag, parent, words, text) => { const e = parent.appendChild(document.createElement(tag)); Object.assign(e, words); if (text) e.textContent = text; return e; };
    const bar = add('div', place, {className: 'controls'});
    const label = add('label', bar, {}, 'mode ');
    const select = add('select', label, {onchange: () => { this.mode = +select.value; this.draw(); }});
    data.modes.forEach((m, k) => add('option', select, {value: k}, m.t));
    this.button = add('button', bar, {type: 'button', className: 'key', onclick: () => this.play(!this.playing)});
    const turn = add('label', bar, {}, 'angle ');
    this.slider = add('input', turn, {type: 'range', min: 0, max: 360, value: 0, oninput: () => { this.play(false); this.angle = this.slider.value / 360; this.draw(); }});
    this.words = add('p', place, {className: 'note'});
    const box = add('div', place, {className: 'chart shapes'});
    this.canvas = add('canvas', box, {});
    this.canvas.setAttribute('role', 'img');
    this.listen();
    new ResizeObserver(() => this.draw()).observe(box);
    new IntersectionObserver(([seen]) => { this.visible = seen.isIntersecting; this.tick(); }).observe(place);
    // Start the motion, unless the reader has asked the system for less motion.
    this.play(!matchMedia('(prefers-reduced-motion: reduce)').matches);
  }

  play(on) {
    this.playing = on;
    this.button.textContent = on ? 'pause' : 'play';
    this.button.setAttribute('aria-pressed', on);
    if (on) this.tick();
    else this.draw();
  }

  tick() {
    if (!this.playing || !this.visible || this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(now => {
      this.waiting = false;
      if (!this.playing || !this.visible) { this.last = null; return; }
      this.angle = (this.angle + (this.last ? Math.min(now - this.last, 100) / 2500 : 0)) % 1;
      this.last = now;
      this.slider.value = Math.round(360 * this.angle);
      this.draw();
      this.tick();
    });
  }

  listen() {
    let from = null;
    this.canvas.addEventListener('pointerdown', e => { from = [e.clientX, e.clientY]; this.canvas.setPointerCapture(e.pointerId); });
    this.canvas.addEventListener('pointermove', e => {
      if (!from) return;
      this.yaw -= (e.clientX - from[0]) / 150;
      this.pitch = Math.max(-1.5, Math.min(1.5, this.pitch + (e.clientY - from[1]) / 150));
      from = [e.clientX, e.clientY];
      this.draw();
    });
    for (const name of ['pointerup', 'pointercancel']) this.canvas.addEventListener(name, () => { from = null; });
  }

  draw() {
    const box = this.canvas.parentElement, fine = window.devicePixelRatio || 1, w = box.clientWidth, h = box.clientHeight;
    if (!w || !h) return;
    if (this.canvas.width !== Math.round(w * fine)) Object.assign(this.canvas, {width: Math.round(w * fine), height: Math.round(h * fine)});
    const c = this.canvas.getContext('2d'), {z, bearings} = this.data, m = this.data.modes[this.mode];
    c.setTransform(fine, 0, 0, fine, 0, 0);
    c.clearRect(0, 0, w, h);
    c.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    // z points to the right, y up, x to the back. The shaft fills the width of the panel.
    const long = z[z.length - 1] - z[0] || 1, thick = 0.3 * Math.max(1, Math.min(2.5, 2.2 * h / w));
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const flat = (a, b, y) => [a * cy + b * sy, -y * cp - (b * cy - a * sy) * sp];
    const corners = [-1, 1].flatMap(a => [-thick, thick].flatMap(b => [-thick, thick].map(y => flat(a, b, y))));
    const size = Math.min((w / 2 - 24) / Math.max(...corners.map(p => p[0])), (h / 2 - 18) / Math.max(...corners.map(p => p[1])));
    const at = (pz, x, y) => {
      const [px, py] = flat(2 * (pz - z[0]) / long - 1, x * thick, y * thick);
      return [w / 2 + size * px, h / 2 + size * py];
    };
    const path = (points, colour, width, dash = []) => {
      c.beginPath();
      points.forEach((p, k) => k ? c.lineTo(...p) : c.moveTo(...p));
      Object.assign(c, {strokeStyle: colour, lineWidth: width});
      c.setLineDash(dash);
      c.stroke();
    };
    const turn = 2 * Math.PI * this.angle, where = (k, t) => [m.x[0][k] * Math.cos(t) - m.x[1][k] * Math.sin(t), m.y[0][k] * Math.cos(t) - m.y[1][k] * Math.sin(t)];
    path([at(z[0], 0, 0), at(z[z.length - 1], 0, 0)], '#7a7a7a', 1);
    for (const [place, name] of bearings) {
      path([at(place, 0, -1), at(place, 0, 1)], '#7a7a7a', 0.8, [2, 3]);
      c.fillStyle = '#7a7a7a';
      const [px, py] = at(place, 0, -1);
      c.fillText(name, px - c.measureText(name).width / 2, py + 13);
    }
    const rings = Math.min(17, z.length);
    for (let r = 0; r < rings; ++r) {
      const k = Math.round(r * (z.length - 1) / Math.max(rings - 1, 1));
      // Forward whirl, from x to y, is blue; backward whirl is orange.
      const forward = m.x[0][k] * m.y[1][k] - m.x[1][k] * m.y[0][k] <= 0;
      path(Array.from({length: 41}, (_, j) => at(z[k], ...where(k, j * Math.PI / 20))), forward ? '#9db9d3' : '#e3b083', 1);
      const [px, py] = at(z[k], ...where(k, turn));
      path([at(z[k], 0, 0), [px, py]], '#d9d9d9', 0.7);
      c.fillStyle = forward ? '#0b62a4' : '#d1670c';
      c.beginPath();
      c.arc(px, py, 2.5, 0, 7);
      c.fill();
    }
    path(z.map((pz, k) => at(pz, ...where(k, turn))), '#222', 2.2);
    for (const [x, y, name] of [[1, 0, 'x'], [0, 1, 'y']]) {
      const end = at(z[0], x, y);
      path([at(z[0], 0, 0), end], '#222', 1);
      c.fillStyle = '#222';
      c.fillText(name, end[0] + 4, end[1]);
    }
    this.words.textContent = `Mode ${m.t}. Blue orbits are forward, orange ones backward; a turn here takes 2.5 s. Drag to look from elsewhere.`;
    this.canvas.setAttribute('aria-label', `The shaft in mode ${m.t}, moving over one turn.`);
  }
}
window.WhirlShapes = WhirlShapes;
