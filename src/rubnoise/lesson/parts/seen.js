/* What has been seen of a run so far: means and spreads from running sums, and who was alive. */
/** Return the standard deviation from a mean and a mean square. */
const spread = (mean, square) => Math.sqrt(Math.max(0, square - mean * mean));

/** Return means and spreads so far: of the contact over distance, of a slider that pushes back over time. */
function moments() {
  const { sums } = rub.run.trace;
  const last = rub.run.ticksSeen;
  const mean = (name) => sums[name][last] / (last + 1);
  const { motion, time } = rub.run;
  const found = { distance: rub.run.reached, ticks: last + 1, velocityStd: Math.sqrt(mean('velocitySquare')) };
  for (const name of ['area', 'count', 'force', 'displacement', 'separation']) {
    found[`${name}Mean`] = mean(name);
    found[`${name}Std`] = spread(mean(name), mean(`${name}Square`));
  }
  const ofMotion = { stuckShare: 0, sticksPerSecond: 0, ...motion?.moments(time) };
  return { ...found, ...ofMotion, ...rub.run.flight?.moments(rub.run.reached) };
}

/** Look at the contact once every mean life, and return the diameters of those alive there, in um. */
function liveDiameters() {
  const { run } = rub;
  const found = [];
  for (let place = 0; place <= run.reached; place += rub.exact().lifeMean)
    for (const row of run.liveAt(place)) found.push(row.diameter);
  return found;
}

Object.assign(rub.run, { moments, liveDiameters });
