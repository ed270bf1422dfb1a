/* Life-lines: a bar from birth to death for each junction, the line of now across them, and how many it crosses. */
const { ink, picture } = rub.plot;
const MARKED = 4; // px of a lane from which on births and deaths are marked
const lives = { lanes: [], ends: [], rows: null };

/** Give every row the lowest lane that is free at its birth. */
function assign(rows) {
  if (lives.rows !== rows) Object.assign(lives, { rows, lanes: [], ends: [] });
  for (let i = lives.lanes.length; i < rows.length; i += 1) {
    lives.lanes.push(rub.laneOf(lives.ends, rows[i].birth, rows[i].death));
  }
}

/** Draw the lives of the stretch on show, as far as they have been seen, above the trace of their count. */
function draw(p) {
  const { run } = rub;
  assign(run.rows);
  const { left, right, top, bottom } = p.frame(undefined, 8, 18, 4);
  const [from, to] = rub.traces.stretch();
  p.x = (place) => left + ((place - from) / (to - from)) * (right - left);
  const { countMean, countStd } = rub.exact();
  const lane = (bottom - top) / Math.max(countMean + 2 * countStd, lives.ends.length);
  for (let i = run.after(from - run.longest); i < run.after(run.reached); i += 1) {
    const row = run.rows[i];
    if (row.death > from) drawLife(p, row, bottom - (lives.lanes[i] + 1) * lane, lane, from);
  }
  p.upright(p.x(run.distance));
  p.heading(`${run.living.length} lives cross the line of now`);
}

function drawLife(p, row, top, lane, from) {
  const { distance, reached, selected } = rub.run;
  const isAlive = row.birth <= distance && row.death > distance;
  const [begin, end] = [p.x(Math.max(row.birth, from)), p.x(Math.min(row.death, reached))];
  const bottom = top + Math.max(1, 0.65 * lane);
  const colour = row.id === selected ? ink.accent : isAlive ? ink.exact : ink.quiet;
  p.ctx.globalAlpha = isAlive || row.id === selected ? 1 : 0.35;
  p.shade(begin, Math.max(begin + 1, end), colour, { top, bottom });
  p.ctx.globalAlpha = 1;
  if (lane < MARKED) return;
  const high = { top: top - 1, bottom: bottom + 1 };
  if (row.birth >= from) p.shade(begin, begin + 2, ink.birth, high);
  if (row.death <= reached) p.shade(end - 2, end, ink.death, high);
}

const counted = rub.estimates.followed(
  () => ({ seen: [] }),
  ({ seen, trace }, tick) => {
    seen[trace.count[tick]] = (seen[trace.count[tick]] ?? 0) + 1;
  },
);

/** Return the probabilities of Poisson's law up to a number. */
lives.poisson = (mean, most) => {
  const found = [Math.exp(-mean)];
  for (let n = 1; n <= most; n += 1) found.push((found[n - 1] * mean) / n);
  return found;
};

/** Draw how often each count has been met so far, on the scale of the trace beside it, and Poisson's bars. */
function drawCounts(p) {
  const { seen, done } = counted();
  const { left, right, top, bottom } = p.frame(4, 4);
  const most = rub.traces.topCount();
  const isRandom = rub.world.births === 'poisson';
  const law = isRandom ? lives.poisson(rub.exact().countMean, most) : [];
  const peak = isRandom ? 1.4 * Math.max(...law) : 1;
  const isShown = isRandom && !rub.readout.veiled();
  const high = (bottom - top) / most;
  const x = (share) => left + Math.min(1, share / peak) * (right - left);
  for (let n = 0; n <= most; n += 1) {
    const y = Math.max(top, bottom - (n + 0.5) * high);
    const tall = Math.min(high, bottom - y);
    p.ctx.globalAlpha = 0.45;
    const end = { top: y, bottom: y + Math.max(1, tall - 0.5) };
    p.shade(left, x((seen[n] ?? 0) / done), ink.quiet, end);
    p.ctx.globalAlpha = 1;
    if (isShown) outline(p, x(law[n]), left, y, y + tall);
  }
  p.heading(isShown ? ['how often, and Poisson’s law', 'Poisson'] : 'how often');
}

/** Draw the end of a bar and its two long sides as far as they do not hide the bars seen. */
function outline(p, end, left, top, bottom) {
  const begin = Math.max(left, end - 5);
  const corners = [[begin, top], [end, top], [end, bottom], [begin, bottom]];
  p.lines([corners], { colour: ink.exact });
}

lives.pictures = [picture('lives', draw), picture('count-histogram', drawCounts)];
rub.lives = lives;
