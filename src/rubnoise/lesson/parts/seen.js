'use strict';
/* What has been seen of a run so far: means and spreads from running sums, and lists from the rows. */
(() => {
  const rub = (globalThis.rub ??= {});

  /** Return the standard deviation from a mean and a mean square. */
  const spread = (mean, square) => Math.sqrt(Math.max(0, square - mean * mean));

  /** Return means and spreads so far: of the contact over distance, of a slider that pushes back over time. */
  function moments() {
    const { sums } = rub.run.trace;
    const last = rub.run.ticksSeen;
    const mean = (name) => sums[name][last] / (last + 1);
    const { motion, time } = rub.run;
    return {
      distance: rub.run.reached,
      ticks: last + 1,
      countMean: mean('count'),
      countStd: spread(mean('count'), mean('countSquare')),
      areaMean: mean('area'),
      areaStd: spread(mean('area'), mean('areaSquare')),
      forceMean: mean('force'),
      forceStd: spread(mean('force'), mean('forceSquare')),
      separationStd: spread(mean('separation'), mean('separationSquare')),
      displacementMean: mean('displacement'),
      displacementStd: spread(mean('displacement'), mean('displacementSquare')),
      velocityStd: Math.sqrt(mean('velocitySquare')),
      stuckShare: 0,
      sticksPerSecond: 0,
      ...motion?.moments(time),
      ...rub.run.flight?.moments(rub.run.reached),
    };
  }

  /** Return the rows born since the start and passed by now. */
  function born() {
    const { run } = rub;
    return run.rows.slice(run.after(0), run.after(run.reached));
  }

  /** Look at the contact once every mean life: who is alive there, and how old. */
  function inspected() {
    const { run } = rub;
    const stride = rub.exact().lifeMean;
    const found = { liveDiameters: [], ages: [], lives: [], counts: [] };
    for (let place = 0; place <= run.reached; place += stride) {
      const live = run.liveAt(place);
      found.counts.push(live.length);
      for (const row of live) {
        found.liveDiameters.push(row.diameter);
        found.ages.push(place - row.birth);
        found.lives.push(2 * rub.model.halfLife(row.diameter, row.offset));
      }
    }
    return found;
  }

  /**
   * Return everything seen so far. Lists: gaps between births (um), diameters at birth, and, once every mean life,
   * liveDiameters, ages and lives of those alive (um) and the counts.
   */
  rub.run.seen = () => {
    const rows = born();
    const gaps = rows.slice(1).map((row, i) => row.birth - rows[i].birth);
    return { ...moments(), births: rows.length, gaps, diameters: rows.map((row) => row.diameter), ...inspected() };
  };

  Object.assign(rub.run, { moments, inspected });
})();
