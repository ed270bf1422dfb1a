'use strict';
/* What a trace says of its spectrum and its memory, brought up to date with every tick that has been passed. */
(() => {
  const rub = (globalThis.rub ??= {});
  const SEGMENT = 1024;
  const LAGS = 66;
  const estimates = {};
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
    welch = current(welch, () => ({ sum: new rub.Welch(SEGMENT) }));
    const { trace, sum } = welch;
    for (; welch.done + SEGMENT <= rub.run.ticksSeen + 1; welch.done += SEGMENT / 2)
      sum.add(trace.area.subarray(welch.done, welch.done + SEGMENT), rub.exact().areaMean);
    const bins = Array.from({ length: sum.segments ? SEGMENT / 2 - 1 : 0 }, (_, i) => i + 1);
    const density = sum.density(trace.tick);
    const wavenumber = bins.map((bin) => (2 * Math.PI * bin) / (SEGMENT * trace.tick));
    return { wavenumber, density: bins.map((bin) => density[bin]), segments: sum.segments };
  };

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

  rub.estimates = estimates;
})();
