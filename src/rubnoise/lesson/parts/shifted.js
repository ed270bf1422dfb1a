/* The trace over itself: the real contact area, and the same curve moved on by a lag that the student chooses. */
const { ink, picture, said, DASHED } = rub.plot;
const LAG = 0.25; // lives, at the beginning
const DOTS = 400;
const APART = 1 / 8; // of a life from one dot to the next
const find = (id) => document.getElementById(id);
const TITLES = ['area, µm²; thick: the same, moved on by the lag', 'area, µm²; thick: a lag on'];
const shifted = { lives: LAG };

/** Return the lag in ticks: whole ones, so that each value has its partner. */
shifted.ticks = () => Math.round((shifted.lives * rub.exact().lifeMean) / rub.run.trace.tick);

/** Return the lag in um. */
shifted.lag = () => shifted.ticks() * rub.run.trace.tick;

/** Draw both curves, and shaded what they have in common. */
function draw(p, seen) {
  p.frame();
  const [from, to] = rub.traces.stretch();
  p.axes([0, rub.traces.topArea(), TITLES], [from, to, 'sliding distance, µm']);
  drawShared(p, from, seen.areaMean);
  p.level(p.y(seen.areaMean), DASHED);
  p.clipped(() => {
    drawCurve(p, from, shifted.ticks(), { colour: ink.accent, width: 2.5 });
    drawCurve(p, from, 0);
  });
}

function drawCurve(p, from, ticks, style) {
  const { trace, ticksSeen } = rub.run;
  const first = Math.max(0, Math.floor(from / trace.tick) - ticks);
  const [x, y] = [(i) => p.x((i + ticks) * trace.tick), (i) => p.y(trace.area[i])];
  p.curve(first, ticksSeen - ticks, x, y, style);
}

/** Return whether both curves are on one side of the mean at a tick. */
function agree(i, ticks, mean) {
  const { area } = rub.run.trace;
  return (area[i] - mean) * (area[i - ticks] - mean) > 0;
}

function drawShared(p, from, mean) {
  const { trace, ticksSeen } = rub.run;
  const ticks = shifted.ticks();
  let begin = -1;
  for (let i = Math.max(ticks, Math.ceil(from / trace.tick)); i <= ticksSeen + 1; i += 1) {
    const isShared = i <= ticksSeen && agree(i, ticks, mean);
    if (isShared && begin < 0) begin = i;
    if (isShared || begin < 0) continue;
    p.shade(p.x(begin * trace.tick), p.x(i * trace.tick), ink.band);
    begin = -1;
  }
}

/** Draw a dot for each value over the one a lag before, on equal axes. */
function drawPairs(p, { areaMean }) {
  const { ctx, width, height } = p;
  const side = Math.min(width - 12, height - 40);
  const box = p.frame(8, width - 8 - side, 18, height - 18 - side);
  const { trace, ticksSeen } = rub.run;
  const at = (area) => (Math.min(area, rub.traces.topArea()) / rub.traces.topArea()) * side;
  p.stroke(() => ctx.rect(box.left, box.top, side, side), { colour: ink.faint, width: 1 });
  p.level(box.bottom - at(areaMean), { ...DASHED, colour: ink.quiet });
  ctx.globalAlpha = 0.5;
  const ticks = shifted.ticks();
  const stride = Math.max(1, Math.round((APART * rub.exact().lifeMean) / trace.tick));
  const last = ticksSeen - (ticksSeen % stride);
  for (let i = last, dots = 0; i >= ticks && dots < DOTS; i -= stride, dots += 1) {
    const [x, y] = [box.left + at(trace.area[i - ticks]), box.bottom - at(trace.area[i])];
    p.shade(x - 1, x + 1.5, ink.ink, { top: y - 1, bottom: y + 1.5 });
  }
  ctx.globalAlpha = 1;
  p.heading('area here');
  p.text('a lag before', box.right, box.bottom + 3, 'right', 'top', ink.quiet);
}

/** Write the lag and, where that gives nothing away, how strongly the curves are correlated so far. */
shifted.write = () => {
  const lives = `${said(shifted.lives, 3)} lives, ${said(shifted.lag(), 3)} µm`;
  const value = rub.readout.isOpen('seen') ? shifted.correlation() : NaN;
  find('lag-said').textContent = Number.isFinite(value) ? `${lives}: correlation ${said(value, 2)}` : lives;
  find('lag').setAttribute('aria-valuetext', lives);
};

/** Return the correlation of the trace with itself at the lag; NaN before there is one. */
shifted.correlation = () => rub.estimates.correlation(shifted.lag());

shifted.begin = () => {
  find('lag').value = LAG;
  find('lag').addEventListener('input', () => {
    shifted.lives = Number(find('lag').value);
    shifted.write();
    rub.emit('lag', shifted.lives);
  });
};

picture('shifted', draw);
picture('pairs', drawPairs);
rub.shifted = shifted;
