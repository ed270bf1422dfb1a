/* Numbers: what is exact, and what has been measured so far. */
const { said } = rub.plot;
const milli = (value) => value * 1e-3;
const tailPower = (exact) => (rub.world.births === 'poisson' ? -exact.tailPower : NaN);
/* Name, label, unit, exact value and measured value, where there are such. */
const LINES = [
  ['count', 'live junctions', '', (e) => e.countMean, (s) => s.countMean],
  ['count-std', 'spread of their number', '', (e) => e.countStd, (s) => s.countStd],
  ['area', 'real contact area', 'µm²', (e) => e.areaMean, (s) => s.areaMean],
  ['area-std', 'spread of the area', 'µm²', (e) => e.areaStd, (s) => s.areaStd],
  ['relative', 'spread of the area over its mean', '', (e) => e.areaStd / e.areaMean, (s) => s.areaStd / s.areaMean],
  [
    'swing',
    'that ratio times √N',
    '',
    (e) => (e.areaStd / e.areaMean) * Math.sqrt(e.countMean),
    (s) => (s.areaStd / s.areaMean) * Math.sqrt(s.countMean),
  ],
  ['tail', 'power of k with which the spectrum ends', '', tailPower, null],
  ['skewness', 'skewness', '', (e) => e.skewness, null],
  ['diameter', 'diameter at birth', 'µm', (e) => e.diameterMean, null],
  ['live-diameter', 'diameter of the living', 'µm', (e) => e.lengthBiasedMean, null],
  ['life', 'mean life', 'µm', (e) => e.lifeMean, null],
  ['spacing', 'gap between births', 'µm', (e) => e.spacing, null],
  ['little', 'mean life over mean gap (Little’s law)', '', (e) => e.lifeMean / e.spacing, null],
  ['force', 'friction force', 'mN', (e) => milli(e.forceMean), (s) => milli(s.forceMean)],
  ['force-std', 'spread of the force', 'mN', (e) => milli(e.forceStd), (s) => milli(s.forceStd)],
  ['displacement', 'displacement', 'µm', (e) => e.displacementMean, (s) => s.displacementMean],
  ['displacement-std', 'spread of the displacement', 'µm', (e) => e.displacementStd, (s) => s.displacementStd],
  ['velocity-std', 'spread of the velocity', 'mm/s', (e) => milli(e.velocityStd), (s) => milli(s.velocityStd)],
  ['frequency', 'natural frequency', 'Hz', (e) => e.naturalFrequency, null],
  ['one-way', 'velocity spread over sliding speed', '', (e) => e.oneWay, (s) => s.velocityStd / rub.world.speed],
  ['stuck', 'share of time stuck', '', null, (s) => s.stuckShare],
  ['sticks', 'sticks a second', '1/s', null, (s) => s.sticksPerSecond],
  ['apart', 'share of time apart', '', null, (s) => s.apartShare],
  ['bearing', 'load over weight', '', () => 1, (s) => s.loadMean],
  ['rise', 'normal velocity, rms', 'mm/s', null, (s) => milli(s.riseStd)],
];
/* Nothing is exact about a motion that acts back on its contact. */
const MOTION = ['displacement', 'displacement-std', 'velocity-std', 'one-way', 'stuck', 'sticks'];
const TWO_WAY = ['stuck', 'sticks'];
/* A slider that hops has these numbers, and none of the others. */
const HOPPING = ['apart', 'bearing', 'rise'];
/** Visible columns: none, seen (what has been measured) or all; shown: the student asked for all of them. */
const readout = { cells: [], level: 'none', shown: false };

readout.isOpen = (column) => readout.shown || readout.level === 'all' || readout.level === column;
/** Return whether even the lines of what is exact stay away from the pictures: until the prediction. */
readout.veiled = () => !readout.shown && readout.level === 'none';

/** Show as much as gives no answer of the open lesson away. */
readout.open = (level) => {
  readout.level = level;
  refresh();
};

function refresh() {
  document.getElementById('numbers-hint').hidden = readout.isOpen('all');
  document.getElementById('numbers-table').hidden = !readout.isOpen('seen');
  readout.exact();
  readout.seen(rub.run.moments());
  rub.emit('veil', readout.level);
}

/** Make the table. */
readout.begin = (body) => {
  document.getElementById('reveal').addEventListener('click', () => {
    readout.shown = true;
    refresh();
  });
  body.innerHTML = LINES.map(
    ([id, label, unit]) =>
      `<tr id="number-${id}"><th scope="row">${label}</th><td></td><td></td><td>${unit}</td></tr>`,
  ).join('');
  readout.cells = LINES.map(([id]) => [...document.getElementById(`number-${id}`).querySelectorAll('td')]);
};

/** Write what is exact. */
readout.exact = () => {
  const exact = rub.exact();
  const twoWay = rub.world.coupling === 'two-way';
  const open = readout.isOpen('all');
  LINES.forEach(([id, , , value], i) => {
    const unknown = twoWay && MOTION.includes(id);
    readout.cells[i][0].textContent = unknown ? '–' : open && value ? said(value(exact), 6) : '';
  });
  const hops = Boolean(rub.run.flight);
  for (const [id] of LINES) {
    const own = hops ? HOPPING.includes(id) : !HOPPING.includes(id) && (twoWay || !TWO_WAY.includes(id));
    document.getElementById(`number-${id}`).hidden = !own;
  }
  document.getElementById('one-way-warning').hidden = !open || hops || twoWay || !(exact.oneWay > 0.1);
};

/** Write what has been measured. */
readout.seen = (seen) => {
  const open = readout.isOpen('seen');
  LINES.forEach(([, , , , value], i) => {
    readout.cells[i][1].textContent = open && value ? said(value(seen)) : '';
  });
};

rub.readout = readout;
