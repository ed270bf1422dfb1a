/* What a trace says of its spectrum and its memory, brought up to date with every tick that has been passed. */
const SEGMENT = 1024;
const LAGS = 76;
const LIVES = 1.5; // up to the last lag
const estimates = {};

/**
 * Return a function that adds up what each tick passed so far brings: anew where the run is another one or has gone
 * back, or what it is added up about is another.
 */
estimates.followed = (begin, add) => {
  let kept = {};
  return (about) => {
    const { trace, ticksSeen } = rub.run;
    if (kept.trace !== trace || kept.about !== about || kept.done > ticksSeen + 1)
      kept = { trace, about, done: 0, ...begin(about) };
    for (; kept.done <= ticksSeen; kept.done += 1) add(kept, kept.done);
    return kept;
  };
};

/* Hann windows of 1024 ticks, each half over the one before, about the exact mean. */
const welch = estimates.followed(
  () => ({ sum: new rub.Welch(SEGMENT) }),
  ({ sum, trace }, tick) => {
    const begin = tick + 1 - SEGMENT;
    if (begin >= 0 && begin % (SEGMENT / 2) === 0) sum.add(trace.area.subarray(begin, tick + 1), rub.exact().areaMean);
  },
);

/** Return the two-sided spectral density of A_r in um^4 per rad/um by Welch's method. */
estimates.spectrum = () => {
  const { trace, sum } = welch();
  const bins = Array.from({ length: sum.segments ? SEGMENT / 2 - 1 : 0 }, (_, i) => i + 1);
  const density = sum.density(trace.tick);
  const wavenumber = bins.map((bin) => (2 * Math.PI * bin) / (SEGMENT * trace.tick));
  return { wavenumber, density: bins.map((bin) => density[bin]), segments: sum.segments };
};

const shared = estimates.followed(
  () => {
    const ticks = (LIVES * rub.exact().lifeMean) / rub.run.trace.tick;
    return { sums: new Float64Array(LAGS), stride: Math.ceil(ticks / (LAGS - 1)) };
  },
  ({ sums, stride, trace }, tick) => {
    const mean = rub.exact().areaMean;
    const now = trace.area[tick] - mean;
    for (let i = 0; i < LAGS && i * stride <= tick; i += 1) sums[i] += now * (trace.area[tick - i * stride] - mean);
  },
);

/** Return the autocovariance of A_r about the exact mean over that at lag 0, at lags up to 1.5 lives. */
estimates.memory = () => {
  const { sums, stride, trace, done } = shared();
  const pairs = (i) => Math.max(1, done - i * stride);
  const lag = Array.from(sums, (_, i) => i * stride * trace.tick);
  return { lag, value: Array.from(sums, (sum, i) => sum / pairs(i) / (sums[0] / pairs(0))) };
};

/** Return the correlation of the trace with itself at a lag in um; NaN before there is one. */
estimates.correlation = (lag) => {
  const { lag: lags, value } = estimates.memory();
  return rub.run.reached < 4 * rub.exact().lifeMean ? NaN : rub.between(value, lag / lags[1]);
};

rub.estimates = estimates;
