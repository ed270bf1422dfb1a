'use strict';
/* Pictures of which one is on show at a time: gaps between births, sizes, the spectrum, the memory. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, pen, line, leftAxis, lowerAxis } = rub.plot;
  const find = (id) => document.getElementById(id);
  const panels = { shown: 'gaps', exact: new Map() };

  const box = () => ({ left: 52, top: 20, right: panels.pen.width - 10, bottom: panels.pen.height - 20 });

  /** Compute something exact once for the settings as they are. */
  function once(name, f) {
    if (!panels.exact.has(name)) panels.exact.set(name, f());
    return panels.exact.get(name);
  }

  /** Draw how often values fall into bins from low to high, as a density; return the scales. */
  function bars(values, low, high, top, titles, colour) {
    const bins = 40;
    const counts = new Float64Array(bins);
    const width = (high - low) / bins;
    for (const value of values) if (value >= low && value < high) counts[Math.floor((value - low) / width)] += 1;
    const { ctx } = panels.pen;
    const [x, y] = [lowerAxis(ctx, box(), low, high, titles[1]), leftAxis(ctx, box(), 0, top, titles[0])];
    ctx.fillStyle = colour;
    const height = (i) => counts[i] / (Math.max(1, values.length) * width);
    for (let i = 0; i < bins; i += 1) {
      const up = y(Math.min(height(i), top));
      ctx.fillRect(x(low + i * width), up, x(low + width) - x(low) - 1, y(0) - up);
    }
    return [x, y];
  }

  function curve(f, low, high, x, y, top) {
    if (rub.readout.veiled()) return;
    const { ctx } = panels.pen;
    ctx.strokeStyle = ink.exact;
    ctx.lineWidth = 2;
    const at = (i) => low + ((high - low) * i) / 200;
    line(
      ctx,
      0,
      200,
      (i) => x(at(i)),
      (i) => y(Math.min(top, f(at(i)))),
    );
  }

  function upright(at, x, y, top) {
    if (rub.readout.veiled()) return;
    const { ctx } = panels.pen;
    ctx.strokeStyle = ink.exact;
    ctx.lineWidth = 2;
    ctx.beginPath();
    ctx.moveTo(x(at), y(0));
    ctx.lineTo(x(at), y(top));
    ctx.stroke();
  }

  /** Gaps between births, with the exponential law or, for regular births, their one gap. */
  function gaps() {
    const { spacing } = rub.exact();
    const { run } = rub;
    const seen = [];
    for (let i = run.after(0) + 1; i < run.after(run.reached); i += 1)
      seen.push(run.rows[i].birth - run.rows[i - 1].birth);
    const regular = rub.world.births === 'regular';
    const top = (regular ? 9 : 1.5) / spacing;
    const [x, y] = bars(
      seen,
      0,
      5 * spacing,
      top,
      [`density of ${seen.length} gaps, 1/µm`, 'gap between births, µm'],
      ink.band,
    );
    if (regular) upright(spacing, x, y, top);
    else curve((gap) => Math.exp(-gap / spacing) / spacing, 0, 5 * spacing, x, y, top);
  }

  /** Diameters of those alive at every mean life, with their law and, dashed, the law of those born. */
  function sizes() {
    const { contact } = rub.exact();
    const { liveDiameters } = rub.run.inspected();
    const law = contact.sizes;
    const reach = Math.max(4 * law.std, 0.1 * law.mean);
    const [low, high] = [Math.max(0, law.mean - reach), law.mean + reach];
    const top = law.std > 0 ? 1.5 * law.density(law.mean) : 2 / reach;
    const titles = [`histogram of ${liveDiameters.length} samples of live junctions, 1/µm`, 'diameter, µm'];
    const [x, y] = bars(liveDiameters, low, high, top, titles, ink.band);
    if (law.std === 0) return upright(law.mean, x, y, top);
    curve((d) => (d * law.density(d)) / law.moment(1), low, high, x, y, top);
    panels.pen.ctx.setLineDash([5, 4]);
    curve((d) => law.density(d), low, high, x, y, top);
    return panels.pen.ctx.setLineDash([]);
  }

  /** The spectrum of the trace by Welch's method, and the exact one, both with logarithms. */
  function spectrum() {
    const { contact, lines } = rub.exact();
    const estimate = rub.estimates.spectrum();
    const [low, high] = [0.3 / contact.diameter, 60 / contact.diameter];
    const points = once('spectrum', () => {
      const at = Array.from({ length: 240 }, (_, i) => low * (high / low) ** (i / 239));
      return at.map((k) => [Math.log10(k), Math.log10(rub.exact().spectrum(k))]);
    });
    const zero = once('shot', () => Math.log10(rub.theory.shotDensity(contact, 0)));
    const titles = ['log₁₀ of the spectral density, µm⁴ per rad/µm', 'log₁₀ of the wavenumber, rad/µm'];
    const { ctx } = panels.pen;
    const y = leftAxis(ctx, box(), zero - 7, zero + 0.7, titles[0]);
    const x = lowerAxis(ctx, box(), Math.log10(low), Math.log10(high), titles[1]);
    clipped(() => {
      strokes(
        estimate.wavenumber.map((k, i) => [Math.log10(k), Math.log10(estimate.density[i])]),
        x,
        y,
        ink.ink,
        1,
      );
      if (!rub.readout.veiled()) strokes(points, x, y, ink.exact, 2);
      if (rub.world.births === 'poisson' && !rub.readout.veiled()) tail(x, y, 7 / contact.diameter, high);
      if (rub.world.births === 'regular')
        for (const each of lines().slice(0, 12)) upright(Math.log10(each.wavenumber), x, () => box().top + 8, 1);
    });
    if (!estimate.segments) hint('the first estimate comes after ten lives');
  }

  /** The level about which the spectrum falls off at last, and its power of the wavenumber. */
  function tail(x, y, from, to) {
    const { ctx } = panels.pen;
    const exact = rub.exact();
    ctx.setLineDash([5, 4]);
    strokes(
      [from, to].map((k) => [Math.log10(k), Math.log10(exact.tail(k))]),
      x,
      y,
      ink.ink,
      1.2,
    );
    ctx.setLineDash([]);
    ctx.fillStyle = ink.ink;
    ctx.textAlign = 'left';
    ctx.textBaseline = 'bottom';
    const name = exact.tailPower === 5 ? 'k⁻⁵' : 'k⁻⁴';
    ctx.fillText(name, x(Math.log10(from)) + 10, y(Math.log10(exact.tail(from))));
  }

  /** The autocovariance of the trace over its variance, and the exact one: nothing beyond one life. */
  function memory() {
    const { lifeMean, autocovariance } = rub.exact();
    const estimate = rub.estimates.memory();
    const high = 1.3 * lifeMean;
    const points = once('memory', () => {
      const lags = Array.from({ length: 66 }, (_, i) => (i / 65) * high);
      const values = lags.map(autocovariance);
      return lags.map((lag, i) => [lag, values[0] > 0 ? values[i] / values[0] : 0]);
    });
    const { ctx } = panels.pen;
    const y = leftAxis(ctx, box(), -0.5, 1.05, 'autocovariance over variance');
    const x = lowerAxis(ctx, box(), 0, high, 'lag, µm');
    clipped(() => {
      strokes(
        estimate.lag.map((lag, i) => [lag, estimate.value[i]]),
        x,
        y,
        ink.ink,
        1,
      );
      if (!rub.readout.veiled()) strokes(points, x, y, ink.exact, 2);
      markLag(x, y);
    });
  }

  /** Mark the lag at which the trace lies over itself, and the correlation there so far. */
  function markLag(x, y) {
    const { ctx } = panels.pen;
    const lag = rub.shifted.lag();
    const value = rub.shifted.correlation();
    ctx.strokeStyle = ctx.fillStyle = ink.accent;
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.moveTo(x(lag), y(-0.5));
    ctx.lineTo(x(lag), y(1.05));
    ctx.stroke();
    if (!Number.isFinite(value)) return;
    ctx.beginPath();
    ctx.arc(x(lag), y(value), 4, 0, 2 * Math.PI);
    ctx.fill();
  }

  function clipped(draw) {
    const { ctx } = panels.pen;
    const { left, top, right, bottom } = box();
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, right - left, bottom - top);
    ctx.clip();
    draw();
    ctx.restore();
  }

  function strokes(points, x, y, colour, width) {
    const { ctx } = panels.pen;
    if (!points.length) return;
    ctx.strokeStyle = colour;
    ctx.lineWidth = width;
    line(
      ctx,
      0,
      points.length - 1,
      (i) => x(points[i][0]),
      (i) => y(points[i][1]),
    );
  }

  function hint(text) {
    const { ctx } = panels.pen;
    ctx.fillStyle = ink.quiet;
    ctx.textAlign = 'center';
    ctx.fillText(text, 0.5 * (box().left + box().right), box().top + 30);
  }

  const DRAW = { gaps, sizes, spectrum, memory };

  /** Draw the picture that is on show. */
  panels.draw = () => {
    panels.pen.clear();
    DRAW[panels.shown]();
  };

  /** Show another picture. */
  panels.open = (name) => {
    if (!DRAW[name]) return;
    panels.shown = name;
    for (const tab of document.querySelectorAll('#tabs [role="tab"]')) {
      const own = tab.dataset.panel === name;
      tab.setAttribute('aria-selected', String(own));
      tab.tabIndex = own ? 0 : -1;
    }
    find('panel').setAttribute('aria-labelledby', `tab-${name}`);
    find('shift').hidden = name !== 'memory';
    rub.shifted.fit();
    panels.pen.fit();
    panels.draw();
  };

  /* As tabs are used everywhere: arrows go to the next one. */
  function press(event) {
    const tabs = [...document.querySelectorAll('#tabs [role="tab"]')];
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const next = tabs[(tabs.indexOf(document.activeElement) + step + tabs.length) % tabs.length];
    panels.open(next.dataset.panel);
    next.focus();
    event.preventDefault();
  }

  panels.begin = () => {
    panels.pen = pen(find('panel-canvas'));
    for (const tab of document.querySelectorAll('#tabs [role="tab"]')) {
      tab.addEventListener('click', () => panels.open(tab.dataset.panel));
    }
    find('tabs').addEventListener('keydown', press);
    rub.on('settings', () => panels.exact.clear());
    panels.open('gaps');
  };

  panels.fit = () => {
    panels.pen.fit();
    panels.draw();
  };

  rub.panels = panels;
})();
