'use strict';
/* What a trace says of its spectrum and its memory, brought up to date with every tick that has been passed. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { fourier } = rub.numbers;
  const SEGMENT = 1024;
  const LAGS = 66;
  const estimates = {};
  const window = Float64Array.from({ length: SEGMENT }, (_, i) => Math.sin((Math.PI * (i + 0.5)) / SEGMENT) ** 2);
  const power = window.reduce((sum, w) => sum + w * w, 0);
  let welch = null;
  let shared = null;

  /** Begin anew where the run is another one or has gone back. */
  function current(kept, make) {
    const { trace, ticksSeen } = rub.run;
    return kept && kept.trace === trace && kept.done <= ticksSeen + 1 ? kept : { trace, done: 0, ...make() };
  }

  /**
   * Return the two-sided spectral density of A_r in um^4 per rad/um by Welch's method, about the exact mean: Hann
   * windows of 1024 ticks, each half over the one before.
   */
  estimates.spectrum = () => {
    welch = current(welch, () => ({ sums: new Float64Array(SEGMENT / 2), segments: 0 }));
    for (; welch.done + SEGMENT <= rub.run.ticksSeen + 1; welch.done += SEGMENT / 2) addSegment(welch);
    const { tick } = welch.trace;
    const wavenumber = [];
    const density = [];
    for (let i = 1; welch.segments && i < SEGMENT / 2; i += 1) {
      wavenumber.push((2 * Math.PI * i) / (SEGMENT * tick));
      density.push(((tick / power) * welch.sums[i]) / welch.segments);
    }
    return { wavenumber, density, segments: welch.segments };
  };

  function addSegment({ trace, done, sums }) {
    const mean = rub.exact().areaMean;
    const re = window.map((w, i) => w * (trace.area[done + i] - mean));
    const im = new Float64Array(SEGMENT);
    fourier(re, im);
    for (let i = 0; i < SEGMENT / 2; i += 1) sums[i] += re[i] * re[i] + im[i] * im[i];
    welch.segments += 1;
  }

  /** Return the autocovariance of A_r about the exact mean over that at lag 0, at lags up to 1.3 lives. */
  estimates.memory = () => {
    shared = current(shared, () => ({ sums: new Float64Array(LAGS) }));
    const { trace, sums } = shared;
    const stride = Math.max(1, Math.round((1.3 * rub.exact().lifeMean) / (LAGS * trace.tick)));
    const mean = rub.exact().areaMean;
    for (; shared.done <= rub.run.ticksSeen; shared.done += 1) {
      const now = trace.area[shared.done] - mean;
      for (let i = 0; i < LAGS && i * stride <= shared.done; i += 1)
        sums[i] += now * (trace.area[shared.done - i * stride] - mean);
    }
    const pairs = (i) => Math.max(1, shared.done - i * stride);
    const lag = Array.from(sums, (_, i) => i * stride * trace.tick);
    return { lag, value: Array.from(sums, (sum, i) => sum / pairs(i) / (sums[0] / pairs(0))) };
  };

  estimates.fourier = fourier;
  rub.estimates = estimates;
})();
