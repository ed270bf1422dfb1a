/* Pictures of which one is on show at a time: gaps between births, sizes, the spectrum, the memory. */
const { ink, picture, DASHED } = rub.plot;
const find = (id) => document.getElementById(id);
const BINS = 40;
const POINTS = 200; // of an exact curve
const panels = { shown: 'gaps', exact: new Map() };
const EXACT = () => ({ colour: ink.exact, width: 2 });

/** Compute something exact once for the settings as they are. */
function once(name, f) {
  if (!panels.exact.has(name)) panels.exact.set(name, f());
  return panels.exact.get(name);
}

/** Draw how often values fall into bins from low to high, as a density. */
function bars(p, values, [low, high, below], top, title) {
  const counts = new Float64Array(BINS);
  const width = (high - low) / BINS;
  for (const value of values) if (value >= low && value < high) counts[Math.floor((value - low) / width)] += 1;
  p.axes([0, top, title], [low, high, below]);
  counts.forEach((count, i) => {
    const up = p.y(Math.min(count / (Math.max(1, values.length) * width), top));
    p.shade(p.x(low + i * width), p.x(low + (i + 1) * width) - 1, ink.band, { top: up, bottom: p.y(0) });
  });
}

/** Draw an exact density, where it gives nothing away. */
function law(p, f, [low, high], top, style) {
  if (rub.readout.veiled()) return;
  const at = (i) => low + ((high - low) * i) / POINTS;
  const y = (i) => p.y(Math.min(top, f(at(i))));
  p.curve(0, POINTS, (i) => p.x(at(i)), y, { ...EXACT(), ...style });
}

/** Draw all of a law at one place. */
function single(p, at) {
  if (!rub.readout.veiled()) p.upright(p.x(at), EXACT());
}

/** Gaps between births, with the exponential law or, for regular births, their one gap. */
function gaps(p) {
  const { spacing } = rub.exact();
  const { run } = rub;
  const rows = run.rows.slice(run.after(0), run.after(run.reached));
  const seen = rows.slice(1).map((row, i) => row.birth - rows[i].birth);
  const regular = rub.world.births === 'regular';
  const top = (regular ? 9 : 1.5) / spacing;
  const axis = [0, 5 * spacing, 'gap between births, µm'];
  bars(p, seen, axis, top, `density of ${seen.length} gaps, 1/µm`);
  if (regular) single(p, spacing);
  else law(p, (gap) => Math.exp(-gap / spacing) / spacing, axis, top);
}

/** Diameters of those alive at every mean life, with their law and, dashed, the law of those born. */
function sizes(p) {
  const { sizes: born } = rub.exact().contact;
  const liveDiameters = rub.run.liveDiameters();
  const reach = Math.max(4 * born.std, 0.1 * born.mean);
  const axis = [Math.max(0, born.mean - reach), born.mean + reach, 'diameter, µm'];
  const top = born.std > 0 ? 1.5 * born.density(born.mean) : 2 / reach;
  bars(p, liveDiameters, axis, top, `histogram of ${liveDiameters.length} samples of live junctions, 1/µm`);
  if (born.std === 0) return single(p, born.mean);
  law(p, (d) => (d * born.density(d)) / born.moment(1), axis, top);
  return law(p, (d) => born.density(d), axis, top, DASHED);
}

/** Draw a line through points in the units of the axes. */
const draw = (p, points, style) => p.lines([points.map(([x, y]) => [p.x(x), p.y(y)])], style);

/** The spectrum of the trace by Welch's method, and the exact one, both with logarithms. */
function spectrum(p) {
  const { contact, lines } = rub.exact();
  const { births } = rub.world;
  const estimate = rub.estimates.spectrum();
  const [low, high] = [0.3 / contact.diameter, 60 / contact.diameter];
  const logs = (k, density) => [Math.log10(k), Math.log10(density)];
  const points = once('spectrum', () => {
    const at = Array.from({ length: 240 }, (_, i) => low * (high / low) ** (i / 239));
    return at.map((k) => logs(k, rub.exact().spectrum(k)));
  });
  const zero = once('shot', () => Math.log10(rub.theory.shotDensity(contact, 0)));
  const across = [Math.log10(low), Math.log10(high), 'log₁₀ of the wavenumber, rad/µm'];
  p.axes([zero - 7, zero + 0.7, 'log₁₀ of the spectral density, µm⁴ per rad/µm'], across);
  p.clipped(() => {
    const seen = estimate.wavenumber.map((k, i) => logs(k, estimate.density[i]));
    draw(p, seen, { width: 1 });
    if (rub.readout.veiled()) return;
    draw(p, points, EXACT());
    if (births === 'poisson') tail(p, 7 / contact.diameter, high, logs);
    if (births !== 'regular') return;
    for (const { wavenumber } of lines().slice(0, 12)) {
      const x = p.x(Math.log10(wavenumber));
      p.upright(x, EXACT(), { top: p.box.top + 8, bottom: p.box.bottom });
    }
  });
  const middle = 0.5 * (p.box.left + p.box.right);
  if (!estimate.segments)
    p.text('the first estimate comes after ten lives', middle, p.box.top + 30, 'center', 'bottom', ink.quiet);
}

/** The level about which the spectrum falls off at last, and its power of the wavenumber. */
function tail(p, from, to, logs) {
  const { tail: level, tailPower } = rub.exact();
  const [first, last] = [from, to].map((k) => logs(k, level(k)));
  draw(p, [first, last], { ...DASHED, width: 1.2 });
  p.text(tailPower === 5 ? 'k⁻⁵' : 'k⁻⁴', p.x(first[0]) + 10, p.y(first[1]));
}

/** The autocovariance of the trace over its variance, and the exact one: nothing beyond one life. */
function memory(p) {
  const { lifeMean, autocovariance } = rub.exact();
  const estimate = rub.estimates.memory();
  const high = 1.3 * lifeMean;
  const points = once('memory', () => {
    const lags = Array.from({ length: 66 }, (_, i) => (i / 65) * high);
    const values = lags.map(autocovariance);
    return lags.map((lag, i) => [lag, values[0] > 0 ? values[i] / values[0] : 0]);
  });
  p.axes([-0.5, 1.05, 'autocovariance over variance'], [0, high, 'lag, µm']);
  p.clipped(() => {
    const seen = estimate.lag.map((lag, i) => [lag, estimate.value[i]]);
    draw(p, seen, { width: 1 });
    if (!rub.readout.veiled()) draw(p, points, EXACT());
    markLag(p);
  });
}

/** Mark the lag at which the trace lies over itself, and the correlation there so far. */
function markLag(p) {
  const [x, value] = [p.x(rub.shifted.lag()), rub.shifted.correlation()];
  p.upright(x, { colour: ink.accent });
  if (Number.isFinite(value)) p.dot(x, p.y(value), ink.accent);
}

const DRAW = { gaps, sizes, spectrum, memory };
picture(
  'panel-canvas',
  (p) => {
    p.frame(52, 10, 20, 20);
    DRAW[panels.shown](p);
  },
  { slow: true },
);

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
  rub.fitAll();
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
  for (const tab of document.querySelectorAll('#tabs [role="tab"]')) {
    tab.addEventListener('click', () => panels.open(tab.dataset.panel));
  }
  find('tabs').addEventListener('keydown', press);
  rub.on('settings', () => panels.exact.clear());
  panels.open('gaps');
};

rub.panels = panels;
