/* A size read off a friction trace: by eye, with a bar laid beside a bump, and by the half of its autocorrelation. */
const LONGEST_LAG = 20; // um
const WIDE = 120; // um of the trace on show
const SHORTEST = 1.2; // um
const LONGEST = 80;
/** What may be seen of the open trace: itself, how others read its size, and the truth. */
const LEVELS = { trace: 0, readings: 1, truth: 2 };
const reading = { law: '', level: LEVELS.trace, known: new Map(), bars: {} };

/** Return the autocovariance over the variance at 0, 1 ... lags ticks, about the mean. */
function correlation(values, lags) {
  const count = values.length;
  const mean = values.reduce((sum, value) => sum + value, 0) / count;
  const size = 2 ** Math.ceil(Math.log2(count + lags));
  const [real, imaginary] = [new Float64Array(size), new Float64Array(size)];
  values.forEach((value, i) => {
    real[i] = value - mean;
  });
  rub.fourier(real, imaginary);
  for (let i = 0; i < size; i += 1) [real[i], imaginary[i]] = [real[i] ** 2 + imaginary[i] ** 2, 0];
  rub.fourier(real, imaginary, 1);
  return Float64Array.from({ length: lags + 1 }, (_, lag) => real[lag] / real[0]);
}

/** Return where values that begin at 1 first fall to one half, in steps from one to the next, by a straight line. */
function halfOf(values) {
  const after = values.findIndex((value) => value < 0.5);
  return after - 1 + (values[after - 1] - 0.5) / (values[after - 1] - values[after]);
}

const { overlap } = rub.model.pulses.lens;
/** The lag over the diameter at which the autocorrelation of equal lenses has fallen to one half. */
reading.yardstick = rub.numbers.lastWhere((lag) => 2 * overlap(lag) > overlap(0), 2);

/** Return what is known of a trace, and what follows from it: forces, correlation and the lag of its half. */
reading.of = (law) => {
  if (!reading.known.has(law)) {
    const given = rub.lesson.readings.find((each) => each.law === law);
    const values = Float64Array.from(rub.unpacked(given.values), (value) => value * given.step);
    const shared = correlation(values, Math.ceil(LONGEST_LAG / given.tick));
    const half = halfOf(shared) * given.tick;
    const top = values.reduce((most, value) => Math.max(most, value), 0);
    reading.known.set(law, { ...given, forces: values, shared, half, top, end: (values.length - 1) * given.tick });
  }
  return reading.known.get(law);
};

/** Return the trace that is open. */
reading.current = () => reading.of(reading.law || rub.lesson.readings[0].law);

/** Return the diameter that Rabinowicz's way gives for a lag, as if all junctions were equal. */
reading.byLag = (lag) => lag / reading.yardstick;

/** Open a trace. */
reading.open = (law) => {
  reading.law = law;
  rub.emit('reading', law);
};

/**
 * Return the bar of the open trace: where its middle is and its length, in um, and whether anybody has laid it. It
 * lies where it was left, at first in the middle of the first stretch.
 */
reading.bar = () => (reading.bars[reading.current().law] ??= { place: WIDE / 2, length: SHORTEST, isLaid: false });

/** Move or stretch the bar of the open trace. */
reading.lay = ({ place, length }) => {
  const bar = reading.bar();
  const { end } = reading.current();
  if (place !== undefined) bar.place = Math.min(end, Math.max(0, place));
  if (length !== undefined) {
    bar.length = Math.min(LONGEST, Math.max(SHORTEST, length));
    bar.isLaid = true;
  }
  rub.emit('reading', reading.law);
};

/** Return the diameter that the bar says: a junction lives for two of them. */
reading.byEye = () => reading.bar().length / 2;

/** Return the stretch of the open trace on show, in um, with the bar in its middle where that can be. */
reading.stretch = () => {
  const { end } = reading.current();
  const from = Math.min(Math.max(0, reading.bar().place - WIDE / 2), end - WIDE);
  return [from, from + WIDE];
};

/**
 * Return the size above which junctions make half of the variance of the trace, in um, and their share of the births:
 * each counts with d^5.
 */
reading.heavy = (given) => {
  const { density } = given;
  const cell = given.largest / density.length;
  const weight = reading.weight(given);
  const whole = total(weight);
  let at = density.length;
  let sum = 0;
  while (sum < 0.5 * whole) sum += weight[(at -= 1)];
  const part = 1 - (sum - 0.5 * whole) / weight[at]; // of the last cell
  return { above: (at + 1 - part) * cell, share: (total(density.slice(at + 1)) + part * density[at]) * cell };
};

const total = (values) => values.reduce((sum, value) => sum + value, 0);

/** Return what the sizes in each cell bring to the variance of a trace, but for a factor: d^5 f(d). */
reading.weight = ({ density, largest }) =>
  density.map((value, i) => value * (((i + 0.5) * largest) / density.length) ** 5);

Object.assign(reading, { LEVELS, SHORTEST, LONGEST });
rub.reading = reading;
