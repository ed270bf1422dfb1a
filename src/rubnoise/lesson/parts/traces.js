/* The traces under the stage, drawn as they grow: real contact area, count, force, displacement, velocity. Those of a
 * slider that pushes back are drawn over time, since it may stand still on the surface.
 */
const { ink, picture, colourOf, DASHED } = rub.plot;
const SWINGS = 30; // of the slider's own motion in a picture of it, but within these numbers of lives
const LIVES = [4, 400];
const MOST_POINTS = 2500;
const MOST_AREAS = 12000; // of single junctions, in a picture
const SLIP = 0;
const DRIVE = { dash: [2, 3] };
const traces = {};
const live = [];
const milli = (value) => 1e-3 * value;

/* The last so much up to a place, or the first. */
const upTo = (place, wide) => (place < wide ? [0, wide] : [place - wide, place]);

/** Return the stretch of distance on show: the last lives up to now, or the first ones. */
traces.stretch = () => upTo(rub.run.reached, rub.run.window);

/** Return the distance that the drive moves in thirty swings of the slider, in um. */
function swings() {
  const { naturalFrequency, lifeMean } = rub.exact();
  const [least, most] = LIVES.map((lives) => lives * lifeMean);
  return Math.min(most, Math.max(least, (SWINGS * rub.world.speed) / naturalFrequency));
}

/** Return the stretch of distance on show in pictures of the slider's motion. */
traces.longStretch = () => upTo(rub.run.reached, swings());

/** Return the stretch of the force: that of the displacement where a lesson shows both. */
function forceStretch() {
  const isLong = document.querySelector('#pictures.folded #panel-slider.shown');
  return isLong ? traces.longStretch() : traces.stretch();
}

/** Return the stretch of time on show, in s. */
const span = () => upTo(rub.run.time, swings() / rub.world.speed);

/** Draw what is exact: a line at the mean, a band of one standard deviation about it; and the mean so far, dashed. */
function drawExact(p, mean, std, seen) {
  if (!rub.readout.veiled()) {
    const [top, bottom] = [p.y(mean + std), p.y(mean - std)];
    p.shade(p.box.left, p.box.right, ink.band, { top, bottom });
    p.level(p.y(mean), { colour: ink.exact });
  }
  p.level(p.y(seen), DASHED);
}

/** Draw one column of the trace over a stretch; of a long one, every so many ticks, always the same ones. */
function drawColumn(p, value, [from, to] = traces.stretch()) {
  const { tick } = rub.run.trace;
  const stride = Math.max(1, Math.ceil((to - from) / tick / MOST_POINTS));
  const step = stride * tick;
  const last = Math.floor(rub.run.ticksSeen / stride);
  const [x, y] = [(i) => p.x(i * step), (i) => p.y(value(i * stride))];
  p.curve(Math.max(0, Math.ceil(from / step)), last, x, y);
}

/** Draw the count, which jumps: level from tick to tick, then upright. */
function drawSteps(p) {
  const { trace, ticksSeen } = rub.run;
  const { count, tick } = trace;
  const first = Math.max(0, Math.ceil(traces.stretch()[0] / tick));
  const corners = [[p.x(first * tick), p.y(count[first])]];
  for (let i = first + 1; i <= ticksSeen; i += 1) {
    if (count[i] === count[i - 1] && i < ticksSeen) continue;
    corners.push([p.x(i * tick), p.y(count[i - 1])], [p.x(i * tick), p.y(count[i])]);
  }
  p.lines([corners]);
}

function axes(p, low, high, title, [from, to] = traces.stretch()) {
  p.frame();
  p.axes([low, high, title], [from, to, 'sliding distance, µm']);
}

/** Draw axes over time, with the times shaded at which the slider is stuck. */
function axesInTime(p, low, high, title) {
  const [from, to] = span();
  const { left, right } = p.frame();
  const x = (time) => left + ((time - from) / (to - from)) * (right - left);
  for (const [begin, end] of rub.run.motion.stuck(from, Math.min(to, rub.run.time)))
    p.shade(x(begin), Math.max(x(begin) + 1, x(end)), ink.stuck);
  p.axes([low, high, title], [1e3 * from, 1e3 * to, 'time, ms']);
}

/** Draw one column of a slider that pushes back, up to now, so many times as large. */
function drawMotion(p, name, factor) {
  const { motion, time } = rub.run;
  const times = motion.columns.time.values;
  const { values } = motion.columns[name];
  const phases = motion.columns.phase.values;
  const first = motion.columns.time.find(span()[0]);
  const last = motion.columns.time.find(time);
  const stride = Math.max(1, Math.ceil((last - first) / MOST_POINTS));
  const at = (t, value) => [p.x(1e3 * t), p.y(factor * value)];
  const points = [at(times[first], values[first])];
  for (let i = first + 1; i <= last; i += 1) {
    const corner = phases[i] !== SLIP || phases[i - 1] !== SLIP; // where it turns, and both ends of a stick
    if (corner || i % stride === 0) points.push(at(times[i], values[i]));
  }
  p.lines([[...points, at(time, motion.at(name, time))]]);
}

/** Return the largest area on show of a contact, in um^2. */
traces.topOf = ({ areaMean, areaStd }) => Math.max(1.25 * areaMean, areaMean + 4.5 * areaStd);
traces.topArea = () => traces.topOf(rub.exact());

function drawArea(p, seen) {
  const { areaMean, areaStd } = rub.exact();
  axes(p, 0, traces.topArea(), 'real contact area, µm²');
  drawStack(p);
  drawExact(p, areaMean, areaStd, seen.areaMean);
  drawColumn(p, (i) => rub.run.trace.area[i]);
}

/** Draw the areas of single junctions, layer upon layer, in columns that stay where they are on the surface. */
function drawStack(p) {
  const { run } = rub;
  const columns = Math.min(p.box.right - p.box.left, MOST_AREAS / Math.max(1, rub.exact().countMean));
  const spacing = run.window / columns;
  /* On whole pixels of the screen: seams would show between columns otherwise. */
  const x = (column) => Math.max(p.box.left, Math.round(p.x(column * spacing) * p.scale) / p.scale);
  const last = Math.floor(run.reached / spacing);
  for (let column = Math.floor(traces.stretch()[0] / spacing); column < last; column += 1)
    drawLayers(p, (column + 0.5) * spacing, x(column), x(column + 1));
  p.ctx.globalAlpha = 1;
}

function drawLayers(p, place, left, right) {
  const { pulse } = rub.run.trace;
  let sum = 0;
  for (const row of rub.run.liveAt(place, live)) {
    const area = pulse.area(place - row.birth, row.diameter, row.offset);
    const isChosen = row.id === rub.run.selected;
    p.ctx.globalAlpha = isChosen ? 1 : row.id % 2 ? 0.62 : 0.88;
    const colour = isChosen ? ink.accent : colourOf(area / rub.stage.largest());
    p.shade(left, right, colour, { top: p.y(sum + area), bottom: p.y(sum) });
    sum += area;
  }
}

/** Return the largest count on show. */
traces.topCount = () => {
  const { countMean, countStd } = rub.exact();
  return Math.ceil(Math.max(countMean + 4.5 * countStd, 1.3 * countMean, 2));
};

function drawCount(p, seen) {
  const { countMean, countStd } = rub.exact();
  axes(p, 0, traces.topCount(), 'live junctions');
  drawExact(p, countMean, countStd, seen.countMean);
  drawSteps(p);
}

function drawForce(p, seen) {
  const { forceMean, forceStd } = rub.exact();
  const { motion, trace } = rub.run;
  const top = milli(rub.world.strength * traces.topArea());
  if (motion) {
    const low = 1.1e-3 * motion.range.force[0];
    axesInTime(p, low, Math.max(top, low + 1e-9), 'friction force, mN');
    return p.clipped(() => drawMotion(p, 'force', 1e-3));
  }
  axes(p, 0, top, 'friction force, mN', forceStretch());
  drawExact(p, milli(forceMean), milli(forceStd), milli(seen.forceMean));
  return drawColumn(p, (i) => milli(trace.force[i]), forceStretch());
}

function drawSlider(p, seen) {
  const { displacementMean, displacementStd } = rub.exact();
  const { motion, trace } = rub.run;
  const title = 'slider displacement, µm';
  if (motion) axesInTime(p, ...traces.reach(), title);
  else axes(p, ...traces.reach(), title, traces.longStretch());
  p.clipped(() => {
    if (motion) {
      p.level(p.y(seen.displacementMean), DASHED);
      drawMotion(p, 'displacement', 1);
    } else {
      drawExact(p, displacementMean, displacementStd, seen.displacementMean);
      drawColumn(p, (i) => trace.displacement[i], traces.longStretch());
      rub.swings.draw(p, traces.longStretch());
    }
  });
}

/** Return the least and largest displacement on show, in um. */
traces.reach = () => {
  const { displacementMean, displacementStd, forceStd } = rub.exact();
  const { motion } = rub.run;
  const spread = motion ? (4 * forceStd) / rub.world.stiffness : 4.5 * displacementStd;
  const half = Math.max(spread, 0.05 * displacementMean);
  const [low, high] = motion ? motion.range.displacement : [Infinity, -Infinity];
  const edge = 0.05 * Math.max(0, high - low);
  return [Math.min(displacementMean - half, low - edge), Math.max(displacementMean + half, high + edge)];
};

/** Draw the velocity, and the speed of the drive wherever it comes into view. */
function drawVelocity(p) {
  const { motion, trace } = rub.run;
  const { speed } = rub.world;
  const reach = 4.5 * rub.exact().velocityStd;
  const [low, high] = motion ? motion.range.velocity : [-reach, reach];
  const [bottom, top] = [Math.min(1.1 * low, -0.02 * speed), Math.max(1.1 * high, 0.02 * speed)];
  const drive = speed < top ? '; dots: the drive' : '';
  const title = [`velocity of the slider, mm/s${drive}`, `velocity, mm/s${drive}`];
  if (motion) axesInTime(p, milli(bottom), milli(top), title);
  else axes(p, milli(bottom), milli(top), title, traces.longStretch());
  p.clipped(() => {
    p.level(p.y(milli(speed)), { ...DRIVE, colour: ink.second });
    if (motion) drawMotion(p, 'velocity', 1e-3);
    else drawColumn(p, (i) => milli(trace.velocity[i]), traces.longStretch());
  });
}

picture('area', drawArea);
picture('count', drawCount);
picture('force', drawForce);
picture('slider', drawSlider);
picture('velocity', drawVelocity);
rub.traces = traces;
