/* A cursor on the trace of the displacement: how long the swings are that it spans. */
const { ink } = rub.plot;
const TEN = 10;
const NEAR = 12; // pixels within which an end is taken up
const swings = { ends: null };
let axis = null; // the frame of the trace, and the stretch on show
let held = -1;

/** Return where the displacement rises through its mean between two distances, in um. */
function risesBetween(from, to) {
  const { trace, ticksSeen } = rub.run;
  const { displacement, tick } = trace;
  const mean = rub.exact().displacementMean;
  const found = [];
  for (let i = Math.max(1, Math.ceil(from / tick)); i <= Math.min(Math.floor(to / tick), ticksSeen); i += 1) {
    const [before, after] = [displacement[i - 1] - mean, displacement[i] - mean];
    if (before < 0 && after >= 0) found.push((i - after / (after - before)) * tick);
  }
  return found;
}

/** Say how long what the cursor spans is, and how many swings it has. */
function told() {
  const [from, to] = [...swings.ends].sort((a, b) => a - b);
  const count = Math.max(0, risesBetween(from - 1e-6, to + rub.run.trace.tick).length - 1);
  const seconds = (to - from) / rub.world.speed;
  const say = (value) => rub.plot.said(value, 4);
  const each = count ? `: ${say(count / seconds)} a second` : '';
  const long = `${say(to - from)} µm, at ${say(rub.world.speed / 1000)} mm/s ${say(seconds)} s`;
  return `${count === TEN ? 'Ten' : count} swings over ${long}${each}.`;
}

/** Lay the cursor over the last ten swings and say what it measures. */
swings.ten = () => {
  if (rub.run.motion) return 'A slider that pushes back has no even swings: it sticks between them.';
  const rises = risesBetween(...rub.traces.longStretch());
  if (rises.length <= TEN) return 'Fewer than ten swings are on show. Slide on.';
  rub.run.pause();
  swings.ends = [rises[rises.length - 1 - TEN], rises[rises.length - 1]];
  rub.emit('lag');
  return told();
};

/** Draw the cursor over the trace. */
swings.draw = (p, range) => {
  axis = { box: p.box, range };
  if (!swings.ends) return;
  const [left, right] = swings.ends.map(p.x).sort((a, b) => a - b);
  p.shade(left, right, ink.band);
  for (const end of [left, right]) p.upright(end, { colour: ink.exact, width: 2 });
};

/** Dragging over the trace spans another stretch; an end that is near is taken up. */
swings.begin = (canvas) => {
  const at = (event) => {
    const { box, range } = axis;
    const part = (event.clientX - canvas.getBoundingClientRect().left - box.left) / (box.right - box.left);
    return range[0] + Math.min(1, Math.max(0, part)) * (range[1] - range[0]);
  };
  const take = (event) => {
    if (!axis || rub.run.motion) return false;
    const place = at(event);
    const { box, range } = axis;
    const near = (NEAR * (range[1] - range[0])) / (box.right - box.left);
    rub.run.pause();
    held = swings.ends ? swings.ends.findIndex((end) => Math.abs(end - place) < near) : -1;
    if (held < 0) [swings.ends, held] = [[place, place], 1];
    return true;
  };
  rub.dragging(canvas, take, (event) => {
    swings.ends[held] = at(event);
    document.getElementById('status').textContent = told();
    rub.emit('lag');
  });
  for (const event of ['settings', 'reset']) {
    rub.on(event, () => {
      swings.ends = null;
    });
  }
};

rub.swings = swings;
