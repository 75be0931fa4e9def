// The charts of a report: zoom, value under the cursor, curves on and off, the orbit of the point under the cursor.
// Each <div class=live> holds its data as JSON, as live.py describes them. Without this script the page shows its pictures.
'use strict';
(() => {
  const {DASHES, GLYPHS, GREY, LIGHT, axis, ground, make, number, tick, valued, wrapped} = Live;

  class Figure {
    constructor(place, data) {
      Object.assign(this, {place, data, option: 0, off: new Set(), followed: new Map()});
      for (const line of data.lines) {
        if (line.off) this.off.add(line.n);
      }
      this.controls();
      const row = make('div', place, {className: data.side ? 'panels beside' : 'panels'});
      this.charts = data.panels.map((panel, k) => this.panel(row, panel, k));
      this.said = make('output', place, {className: 'said'});
      this.said.setAttribute('aria-live', 'polite');
      // Until the cursor points at a branch, the panel beside it shows the orbit from the middle of the branch.
      data.lines.forEach(line => {
        if (line.f != null && !this.followed.has(line.n)) {
          this.followed.set(line.n, this.middle(line));
          this.last = this.last || line.n;
        }
      });
      this.refresh();
    }

    middle(line) {
      const every = this.data.lines.filter(l => l.f != null && l.n === line.n && l.o === line.o);
      return every[every.length >> 1].f;
    }

    controls() {
      const bar = make('div', this.place, {className: 'controls'}), {choose} = this.data;
      if (choose && choose.of.length > 1) {
        const label = make('label', bar, {}, choose.name + ' ');
        const select = make('select', label);
        choose.of.forEach((words, k) => make('option', select, {value: k}, words));
        select.onchange = () => { this.option = +select.value; this.whole(); this.refresh(); };
      } else if (choose && choose.of.length) make('span', bar, {className: 'style'}, choose.of[0]);
      const names = new Map();
      // Buttons of curves come before buttons of marks. The button of a curve shows a solid line if a stretch of the curve is solid.
      for (const marked of [false, true]) {
        for (const line of this.data.lines) if (line.n && !(line.m || line.dots) === !marked && (!names.has(line.n) || names.get(line.n).d && !line.d)) names.set(line.n, line);
      }
      if (names.size > 1) for (const [name, line] of names) this.key(bar, name, line);
      if (names.size > 4) {
        for (const [words, hidden] of [['all', []], ['none', [...names.keys()]]]) {
          make('button', bar, {type: 'button', className: 'key', onclick: () => { this.off = new Set(hidden); this.pressed(bar); this.refresh(); }}, words);
        }
      }
      this.reset = make('button', bar, {type: 'button', className: 'key reset', hidden: true, onclick: () => this.whole()}, 'whole range');
      for (const {d, c, t} of this.data.keys || this.data.styles || []) if (t) this.swatch(make('span', bar, {className: 'style'}), c || GREY, d, t);
    }

    swatch(parent, colour, dash, words, marker) {
      const place = make('span', parent, {className: 'swatch'}, marker ? GLYPHS[marker] : '');
      if (marker) place.style.color = colour;
      else place.innerHTML = '<svg width="24" height="6"><line x1="0" y1="3" x2="24" y2="3" stroke-width="2.5"/></svg>';
      const drawn = place.querySelector('line');
      if (drawn) {
        drawn.setAttribute('stroke', colour);
        drawn.setAttribute('stroke-dasharray', DASHES[dash || 0].join(' '));
      }
      parent.append(' ' + words);
    }

    key(bar, name, line) {
      const button = make('button', bar, {type: 'button', className: 'key toggle'});
      button.dataset.name = name;
      button.setAttribute('aria-pressed', !this.off.has(name));
      this.swatch(button, line.c, line.d, name, line.m || (line.dots && 'circle'));
      button.onclick = () => { this.off.has(name) ? this.off.delete(name) : this.off.add(name); this.pressed(bar); this.refresh(); };
    }

    pressed(bar) {
      for (const b of bar.querySelectorAll('.toggle')) b.setAttribute('aria-pressed', !this.off.has(b.dataset.name));
    }

    // Turns a line of the data into a dataset of Chart.js. A stretch between two points has the style of its first point.
    dataset(line) {
      const styles = this.data.styles || [], of = i => line.s ? styles[parseInt(line.s[i], 36)] || {} : {};
      const found = {
        line, label: line.n || '', data: line.x.map((x, i) => ({x, y: line.y[i]})), borderColor: line.c, backgroundColor: line.c,
        borderWidth: line.w || 1.6, borderDash: DASHES[line.d || 0], showLine: !line.m, pointStyle: line.m || 'circle', pointRadius: line.m ? 6 : line.x.length === 1 ? 3 : 0,
        pointHoverRadius: line.quiet ? 0 : line.m ? 8 : 4, pointHitRadius: 0, pointBorderColor: !line.m || line.m.startsWith('cross') ? line.c : '#fff', pointBorderWidth: line.m ? 1.5 : 1, spanGaps: false,
        // At tension 0 Chart.js leaves out points that share a column of pixels with others. This suits a function of x, but distorts an orbit:
        // a tiny tension keeps all points.
        tension: this.data.panels[line.p || 0].by === 'x' ? 0 : 1e-6,
        order: line.m ? 0 : line.quiet ? 2 : 1,
      };
      if (line.hollow) Object.assign(found, {pointBackgroundColor: 'transparent', pointBorderColor: line.c});
      if (line.s) found.segment = {
        borderColor: c => of(c.p0DataIndex).c || line.c,
        borderDash: c => DASHES[of(c.p0DataIndex).d ?? line.d ?? 0],
      };
      if (line.bare || line.dots) Object.assign(found, {showLine: false, pointRadius: line.dots ? 2 : 0});
      return found;
    }

    shown(k) {
      return this.data.lines.filter(l => (l.p || 0) === k && (l.o == null || l.o === this.option) && !this.off.has(l.n)
        && (l.f == null || l.n === this.last && l.f === this.followed.get(l.n)));
    }

    fill(chart, k) {
      if (chart.whirl.room) chart.whirl.room[3] = 0;
      const lines = this.shown(k);
      chart.data.datasets = lines.map(l => this.dataset(l));
      if (chart.whirl.panel.follows) chart.options.plugins.title.text = lines.filter(l => l.f != null).map(l => l.t0);
    }

    refresh() {
      this.charts.forEach((chart, k) => {
        this.fill(chart, k);
        this.fit(chart);
        chart.update('none');
      });
    }

    words(chart, item) {
      const line = item.dataset.line, {x, y} = chart.whirl.panel, i = item.dataIndex, name = line.n ? line.n + ': ' : '';
      if (line.t) return line.t[i];
      const style = line.s && this.data.styles[parseInt(line.s[Math.min(i, line.s.length - 1)], 36)];
      return `${name}${valued(line.y[i], line.u == null ? y[1] : line.u, line.b && line.b[i])}${chart.whirl.panel.equal ? `, ${x[0]} ${valued(line.x[i], x[1])}` : ''}`
        + (line.more || []).map(([what, unit, v, bar]) => `, ${what} ${valued(v[i], unit, bar && bar[i])}`).join('') + (style && style.t ? `, ${style.t}` : '');
    }

    panel(row, panel, k) {
      const box = make('div', row, {className: panel.equal ? 'chart square' : 'chart'});
      if (panel.height) box.style.height = panel.height + 'px';
      const canvas = make('canvas', box, {tabIndex: 0});
      canvas.setAttribute('role', 'img');
      canvas.setAttribute('aria-label', `${axis(panel.y)} over ${axis(panel.x)}. Arrow keys move along the curves, plus and minus zoom, 0 shows the whole range.`);
      const state = {panel, k, frame: null, fit: () => this.fit(chart)}, title = words => ({display: true, text: words, font: {size: 12}});
      const chart = new Chart(canvas, {
        type: 'line', data: {datasets: []}, plugins: [ground(state)],
        options: {
          responsive: true, maintainAspectRatio: false, layout: {padding: {right: 16}},
          interaction: {mode: 'value', axis: panel.by || 'xy', intersect: false},
          onHover: (event, items, c) => this.pointed(c, items),
          scales: {
            x: {type: panel.logx ? 'logarithmic' : 'linear', title: title(axis(panel.x)), grid: {color: LIGHT}, ticks: {maxRotation: 0, includeBounds: false, font: {size: 11}, callback: tick(panel.logx)}},
            y: {type: panel.log ? 'logarithmic' : 'linear', reverse: !!panel.reverse, title: title(axis(panel.y)), grid: {color: LIGHT}, grace: panel.log || panel.equal ? 0 : '4%',
                ticks: {font: {size: 11}, includeBounds: false, callback: tick(panel.log), ...(panel.step ? {stepSize: panel.step} : {})}, afterFit: s => { s.width = Math.max(s.width, s.chart.width < 500 ? 62 : 76); }},
          },
          plugins: {
            legend: {display: false},
            title: {display: !!panel.title || !!panel.follows, text: panel.title || '', align: 'start', font: {size: 12}, padding: {top: 0, bottom: 4}},
            tooltip: {
              filter: item => !item.dataset.line.quiet, displayColors: false, boxPadding: 2, bodyFont: {size: 11}, titleFont: {size: 11},
              callbacks: {
                title: items => items.length && !panel.equal && !items[0].dataset.line.t ? `${panel.x[0]} ${valued(items[0].parsed.x, panel.x[1])}` : '',
                label: item => wrapped(this.words(item.chart, item), item.chart.width),
              },
            },
          },
        },
      });
      chart.whirl = state;
      this.listen(canvas, chart);
      return chart;
    }

    pointed(chart, items) {
      const first = items.find(({datasetIndex: d}) => !chart.data.datasets[d].line.quiet);
      if (!first) return;
      const line = chart.data.datasets[first.datasetIndex].line;
      if (line.at != null && line.at[first.index] != null) this.follow(line.n, line.at[first.index]);
    }

    // Shows the kept orbit that is nearest along the branch.
    follow(name, point) {
      const every = this.data.lines.filter(l => l.f != null && l.n === name && (l.o == null || l.o === this.option));
      if (!every.length) return;
      const near = every.reduce((a, b) => Math.abs(b.f - point) < Math.abs(a.f - point) ? b : a).f;
      if (this.followed.get(name) === near && this.last === name) return;
      this.followed.set(name, near);
      this.last = name;
      this.charts.forEach((chart, k) => {
        if (!chart.whirl.panel.follows) return;
        this.fill(chart, k);
        this.fit(chart);
        chart.update('none');
      });
    }

    // The axes end where the zoom ends, without a zoom where the panel does. A panel with equal scales then shows all curves.
    fit(chart) {
      const {panel, zoom} = chart.whirl, {x, y} = chart.options.scales;
      if (panel.equal) {
        let box = zoom;
        if (!box) {
          const every = chart.data.datasets.map(d => d.line), all = k => every.flatMap(l => l[k]).filter(v => v != null);
          if (!all('x').length) return;
          const low = v => v.reduce((a, b) => Math.min(a, b)), high = v => v.reduce((a, b) => Math.max(a, b));
          box = {x: [low(all('x')), high(all('x'))], y: [low(all('y')), high(all('y'))]};
        }
        const [w, h] = chart.whirl.room || [1, 1];
        const scale = (zoom ? 1 : 1.08) * Math.max((box.x[1] - box.x[0]) / w, (box.y[1] - box.y[0]) / h, 1e-12);
        for (const [s, [from, to], size] of [[x, box.x, w], [y, box.y, h]]) {
          s.min = (from + to - scale * size) / 2;
          s.max = (from + to + scale * size) / 2;
        }
        return;
      }
      [x.min, x.max] = (zoom || {}).x || panel.span || [undefined, undefined];
      [y.min, y.max] = (zoom || {}).y || panel.limits || [undefined, undefined];
      if (!zoom && panel.low != null) y.min = panel.low;
      y.grace = zoom || panel.log ? 0 : '4%';
    }

    zoomed(chart, x, y) {
      this.charts.forEach(c => {
        if (c !== chart && (chart.whirl.panel.equal || c.whirl.panel.equal)) return;
        // A logarithmic axis cannot show zero or less: keep its lower end there.
        const above = (v, s) => v && s.type === 'logarithmic' && v[0] <= 0 ? [s.min, v[1]] : v;
        c.whirl.zoom = {x: above(x, c.scales.x), y: c === chart ? above(y, c.scales.y) : (c.whirl.zoom || {}).y};
        this.fit(c);
        c.update('none');
      });
      this.reset.hidden = false;
    }

    whole() {
      this.reset.hidden = true;
      this.charts.forEach(c => { c.whirl.zoom = null; this.fit(c); c.update('none'); });
    }

    listen(canvas, chart) {
      const inside = e => {
        const r = canvas.getBoundingClientRect(), a = chart.chartArea;
        return [Math.min(Math.max(e.clientX - r.left, a.left), a.right), Math.min(Math.max(e.clientY - r.top, a.top), a.bottom)];
      };
      let start = null;
      canvas.addEventListener('pointerdown', e => { if (e.isPrimary && e.button === 0) start = inside(e); });
      canvas.addEventListener('pointermove', e => {
        if (!start) return;
        const [px, py] = inside(e), a = chart.chartArea, wide = e.pointerType === 'touch' && !chart.whirl.panel.equal;
        if (Math.abs(px - start[0]) + Math.abs(py - start[1]) < 6) return;
        if (!chart.whirl.frame) canvas.setPointerCapture(e.pointerId);
        // A frame of almost no width or height zooms along the other axis only.
        const flat = wide || Math.abs(py - start[1]) < 12, thin = !wide && Math.abs(px - start[0]) < 12;
        chart.whirl.frame = {x0: thin ? a.left : start[0], x1: thin ? a.right : px, y0: flat ? a.top : start[1], y1: flat ? a.bottom : py, flat, thin};
        chart.draw();
      });
      const end = e => {
        const f = chart.whirl.frame, {x, y} = chart.scales;
        start = chart.whirl.frame = null;
        if (!f) return;
        const sorted = (s, a, b) => [s.getValueForPixel(a), s.getValueForPixel(b)].sort((p, q) => p - q);
        if (e.type === 'pointerup' && f.x0 !== f.x1 && f.y0 !== f.y1) {
          this.zoomed(chart, f.thin ? [x.min, x.max] : sorted(x, f.x0, f.x1), f.flat && !chart.whirl.panel.equal ? (chart.whirl.zoom || {}).y : sorted(y, f.y0, f.y1));
        } else chart.draw();
      };
      canvas.addEventListener('pointerup', end);
      canvas.addEventListener('pointercancel', end);
      canvas.addEventListener('dblclick', () => this.whole());
      canvas.addEventListener('keydown', e => this.typed(e, chart));
    }

    typed(e, chart) {
      const usable = chart.data.datasets.map((d, k) => k).filter(k => !chart.data.datasets[k].line.quiet);
      if (!usable.length || e.ctrlKey || e.metaKey || e.altKey) return;
      let [d, i] = chart.whirl.at || [usable[0], 0];
      if (!usable.includes(d)) [d, i] = [usable[0], 0];
      const size = chart.data.datasets[d].data.length, step = e.shiftKey ? 10 : 1, {x, y} = chart.scales;
      if (e.key === 'ArrowRight') i = Math.min(i + step, size - 1);
      else if (e.key === 'ArrowLeft') i = Math.max(i - step, 0);
      else if (e.key === 'ArrowUp' || e.key === 'ArrowDown') {
        const here = chart.data.datasets[d].data[i] || {x: x.min};
        d = usable[(usable.indexOf(d) + (e.key === 'ArrowUp' ? 1 : usable.length - 1)) % usable.length];
        const away = chart.data.datasets[d].data.map(p => p.y == null ? Infinity : Math.abs(p.x - here.x));
        i = away.indexOf(Math.min(...away));
      } else if (e.key === '+' || e.key === '=' || e.key === '-') {
        const here = (chart.whirl.at && chart.data.datasets[d].data[i]) || {x: (x.min + x.max) / 2, y: (y.min + y.max) / 2};
        const half = s => (s.max - s.min) * (e.key === '-' ? 1 : 0.25), about = (s, v) => [v - half(s), v + half(s)];
        this.zoomed(chart, about(x, here.x), chart.whirl.panel.equal ? about(y, here.y) : (chart.whirl.zoom || {}).y);
      } else if (e.key === '0' || e.key === 'Escape') this.whole();
      else return;
      e.preventDefault();
      const active = [{datasetIndex: d, index: i}], point = chart.getDatasetMeta(d).data[i];
      if (!point) return;
      chart.whirl.at = [d, i];
      chart.setActiveElements(active);
      chart.tooltip.setActiveElements(active, {x: point.x, y: point.y});
      chart.update('none');
      this.pointed(chart, active);
      const line = chart.data.datasets[d].line;
      this.said.textContent = `${chart.whirl.panel.x[0]} ${valued(line.x[i], chart.whirl.panel.x[1])}: ${this.words(chart, {dataset: {line}, dataIndex: i})}`;
    }
  }

  // Makes the figure of a place. This is called when the reader scrolls near it; a page has too many figures to make all of them at once.
  const build = place => {
    if (place.whirl) return;
    const data = JSON.parse(place.querySelector('script').textContent);
    try {
      place.whirl = data.kind === 'shapes' ? new WhirlShapes(place, data) : new Figure(place, data);
    } catch (error) {
      console.error(error);
      place.parentElement.classList.remove('charted');  // the page shows the picture instead
    }
  };
  const near = new IntersectionObserver(seen => seen.forEach(s => {
    if (s.isIntersecting) { near.unobserve(s.target); build(s.target); }
  }), {rootMargin: '800px'});
  for (const place of document.querySelectorAll('.live')) {
    place.parentElement.classList.add('charted');
    near.observe(place);
  }
  document.documentElement.classList.add('has-charts');
})();
