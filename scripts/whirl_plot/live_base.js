// Functions that all charts of a report use: numbers as text, the search for the point under the cursor, the background of a panel.
'use strict';
const Live = (() => {
  const INK = '#222', GREY = '#7a7a7a', LIGHT = '#e3e7ec';
  const DASHES = {0: [], 1: [6, 4], 2: [2, 3], 3: [9, 3, 2, 3]};
  const GLYPHS = {circle: '●', rect: '■', rectRot: '◆', triangle: '▲', cross: '✚', crossRot: '✖'};
  const make = (tag, parent, words = {}, text = '') => {
    const e = parent.appendChild(document.createElement(tag));
    Object.assign(e, words);
    if (text) e.textContent = text;
    return e;
  };
  const number = v => v == null || !isFinite(v) ? '–' : v === 0 ? '0' : String(Math.abs(v) < 1e-4 || Math.abs(v) >= 1e7
    ? v.toExponential(3) : +v.toPrecision(5)).replace(/-/g, '−');
  const raised = n => String(n).replace(/./g, c => '⁰¹²³⁴⁵⁶⁷⁸⁹'['0123456789'.indexOf(c)] || '⁻');
  // Tick labels. A logarithmic axis shows 1, 2 and 5 of each decade; if it spans many decades, powers of ten only.
  const tick = log => !log ? number : function (v) {
    const power = Math.floor(Math.log10(v) + 1e-9), first = Math.round(v / 10 ** power), wide = Math.log10(this.max / this.min) > 2.5;
    if (!(wide ? [1] : [1, 2, 5]).includes(first)) return null;
    return power >= -2 && power < 6 ? number(v) : `${first === 1 ? '' : first + '·'}10${raised(power)}`;
  };
  const axis = ([name, unit]) => unit ? `${name} [${unit}]` : name;
  // A value and its bar: two digits of the bar, and the value cut to them.
  const barred = (v, bar) => {
    if (v == null || !(bar > 1e-9 * Math.abs(v))) return number(v);
    const last = Math.floor(Math.log10(bar)) - 1, cut = n => (last > 0 ? Math.round(n / 10 ** last) * 10 ** last : n).toFixed(Math.min(12, Math.max(0, -last)));
    return `${cut(v)} ± ${cut(bar)}`.replace(/-/g, '−');
  };
  const valued = (v, unit, bar) => unit ? `${barred(v, bar)} ${unit}` : barred(v, bar);

  // Finds what the tooltip shows: a mark if the cursor is on one, or else the nearest computed point. Panels over `x` show one point of each
  // curve, the nearest along x.
  Chart.Interaction.modes.value = (chart, e, {axis}) => {
    const found = [], {left, right, top, bottom} = chart.chartArea, inside = p => p.x >= left - 1 && p.x <= right + 1 && p.y >= top - 1 && p.y <= bottom + 1;
    chart.data.datasets.forEach(({line}, datasetIndex) => {
      if (line.quiet) return;
      let best = null;
      chart.getDatasetMeta(datasetIndex).data.forEach((element, index) => {
        if (element.skip || !(axis === 'x' ? element.x >= left - 1 && element.x <= right + 1 : inside(element))) return;
        const away = axis === 'x' && !line.m ? Math.abs(element.x - e.x) : Math.hypot(element.x - e.x, element.y - e.y);
        if (!best || away < best.away) best = {element, datasetIndex, index, away, mark: !!line.m};
      });
      if (best) found.push(best);
    });
    const marks = found.filter(f => f.mark && f.away < 9), least = list => Math.min(...list.map(f => f.away));
    if (marks.length) return marks.filter(f => f.away === least(marks)).slice(0, 1);
    const points = found.filter(f => !f.mark), near = points.filter(f => f.away <= least(points) + (axis === 'x' ? 0.5 : 0));
    return axis === 'x' ? near : near.slice(0, 1);
  };

  Chart.defaults.animation = false;
  Chart.defaults.elements.line.capBezierPoints = false;
  Chart.defaults.font.family = "system-ui, 'DejaVu Sans', sans-serif";
  Chart.defaults.color = INK;

  // Bands of unstable stretches, lines at named places, and the frame that is dragged.
  const ground = state => ({
    id: 'ground',
    // Equal scales depend on the size of the plot area, which is known only after titles and tick labels have their place.
    afterLayout(chart) {
      const a = chart.chartArea, size = `${chart.width} ${chart.height}`, known = state.room || [];
      const same = known[2] === size;
      if (!state.panel.equal || !(a.width > 0 && a.height > 0) || same && (known[3] > 3 || a.width === known[0] && a.height === known[1])) return;
      state.room = [a.width, a.height, size, same ? known[3] + 1 : 0];  // new limits may change the tick labels and with them the size again: stop after a few rounds
      queueMicrotask(() => { state.fit(); chart.update('none'); });
    },
    beforeDatasetsDraw(chart) {
      const {ctx, chartArea: a, scales: {x}} = chart;
      ctx.save();
      ctx.beginPath();
      ctx.rect(a.left, a.top, a.width, a.height);
      ctx.clip();
      for (const [from, to] of state.panel.bands || []) {
        ctx.fillStyle = 'rgba(200,16,46,.07)';
        const l = x.getPixelForValue(from);
        ctx.fillRect(l, a.top, x.getPixelForValue(to) - l, a.height);
      }
      for (const [at, words] of state.panel.places || []) {
        const p = x.getPixelForValue(at);
        ctx.strokeStyle = GREY;
        ctx.setLineDash([2, 3]);
        ctx.beginPath();
        ctx.moveTo(p, a.top);
        ctx.lineTo(p, a.bottom);
        ctx.stroke();
        ctx.fillStyle = GREY;
        ctx.save();
        ctx.translate(p - 3, a.top + 4);
        ctx.rotate(-Math.PI / 2);
        ctx.textAlign = 'right';
        ctx.font = '10px ' + Chart.defaults.font.family;
        ctx.fillText(words, 0, 0);
        ctx.restore();
      }
      ctx.restore();
    },
    afterDraw(chart) {
      const {ctx} = chart, f = state.frame;
      if (!f) return;
      ctx.save();
      ctx.fillStyle = 'rgba(11,98,164,.12)';
      ctx.strokeStyle = '#0b62a4';
      ctx.fillRect(f.x0, f.y0, f.x1 - f.x0, f.y1 - f.y0);
      ctx.strokeRect(f.x0, f.y0, f.x1 - f.x0, f.y1 - f.y0);
      ctx.restore();
    },
  });

  // Breaks a text into lines that fit a narrow screen.
  const wrapped = (words, width) => {
    const most = Math.max(24, Math.min(70, width / 7.5)), lines = [''];
    for (const word of words.split(' ')) {
      if (lines[lines.length - 1] && (lines[lines.length - 1] + ' ' + word).length > most) lines.push(word);
      else lines[lines.length - 1] = (lines[lines.length - 1] + ' ' + word).trim();
    }
    return lines;
  };

  return {DASHES, GLYPHS, GREY, LIGHT, axis, ground, make, number, tick, valued, wrapped};
})();
