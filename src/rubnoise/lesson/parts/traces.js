'use strict';
/* The traces under the stage, drawn as they grow: real contact area, count, force, displacement, velocity. Those of a
 * slider that pushes back are drawn over time, since it may stand still on the surface.
 */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, pen, line, leftAxis, lowerAxis } = rub.plot;
  const LEFT = 46;
  const SWINGS = 30; // of the slider's own motion in a picture of it, but within these numbers of lives
  const LIVES = [4, 400];
  const MOST_POINTS = 2500;
  const SLIP = 0;
  const traces = { pens: {} };

  /** Return the stretch of distance on show: the last lives up to now, or the first ones. */
  function stretch() {
    const { reached, window } = rub.run;
    return reached < window ? [0, window] : [reached - window, reached];
  }

  /** Return the distance that the drive moves in thirty swings of the slider, in um. */
  function swings() {
    const { naturalFrequency, lifeMean } = rub.exact();
    const [least, most] = LIVES.map((lives) => lives * lifeMean);
    return Math.min(most, Math.max(least, (SWINGS * rub.world.speed) / naturalFrequency));
  }

  /** Return the stretch of distance on show in pictures of the slider's motion. */
  function longStretch() {
    const { reached } = rub.run;
    const wide = swings();
    return reached < wide ? [0, wide] : [reached - wide, reached];
  }

  /** Return the stretch of the force: that of the displacement where a lesson shows both. */
  function forceStretch() {
    return document.querySelector('#pictures.folded #panel-slider.shown') ? longStretch() : stretch();
  }

  /** Return the stretch of time on show, in s. */
  function span() {
    const { time } = rub.run;
    const wide = swings() / rub.world.speed;
    return time < wide ? [0, wide] : [time - wide, time];
  }

  function boxOf({ width, height }) {
    return { left: LEFT, top: 18, right: width - 8, bottom: height - 18 };
  }

  /** Draw what is exact: a line at the mean, a band of one standard deviation about it; and the mean so far, dashed. */
  function drawExact(ctx, box, y, mean, std, seen) {
    if (!rub.readout.veiled()) {
      ctx.fillStyle = ink.band;
      ctx.fillRect(box.left, y(mean + std), box.right - box.left, y(mean - std) - y(mean + std));
      level(ctx, box, y(mean), ink.exact, []);
    }
    level(ctx, box, y(seen), ink.ink, [5, 4]);
  }

  function level(ctx, box, y, colour, dashes) {
    ctx.strokeStyle = colour;
    ctx.lineWidth = 1.5;
    ctx.setLineDash(dashes);
    ctx.beginPath();
    ctx.moveTo(box.left, y);
    ctx.lineTo(box.right, y);
    ctx.stroke();
    ctx.setLineDash([]);
  }

  /** Draw one column of the trace over a stretch; of a long one, every so many ticks, always the same ones. */
  function drawColumn(ctx, x, y, values, [from, to] = stretch()) {
    const { tick } = rub.run.trace;
    const stride = Math.max(1, Math.ceil((to - from) / tick / MOST_POINTS));
    const step = stride * tick;
    ctx.strokeStyle = ink.ink;
    ctx.lineWidth = 1.5;
    ctx.lineJoin = 'round';
    line(
      ctx,
      Math.max(0, Math.ceil(from / step)),
      Math.floor(rub.run.ticksSeen / stride),
      (i) => x(i * step),
      (i) => y(values[i * stride]),
    );
  }

  /** Draw a column that jumps: level from tick to tick, then upright. */
  function drawSteps(ctx, x, y, values) {
    const { trace, ticksSeen } = rub.run;
    const first = Math.max(0, Math.ceil(stretch()[0] / trace.tick));
    ctx.strokeStyle = ink.ink;
    ctx.lineWidth = 1.5;
    ctx.lineJoin = 'miter';
    ctx.beginPath();
    ctx.moveTo(x(first * trace.tick), y(values[first]));
    for (let i = first + 1; i <= ticksSeen; i += 1) {
      if (values[i] === values[i - 1] && i < ticksSeen) continue;
      ctx.lineTo(x(i * trace.tick), y(values[i - 1]));
      ctx.lineTo(x(i * trace.tick), y(values[i]));
    }
    ctx.stroke();
  }

  function frame(name, low, high, title, [from, to] = stretch()) {
    const state = traces.pens[name];
    state.clear();
    const box = boxOf(state);
    const y = leftAxis(state.ctx, box, low, high, title);
    return { ctx: state.ctx, box, x: lowerAxis(state.ctx, box, from, to, 'sliding distance, µm'), y };
  }

  /** As frame, over time, with the times shaded at which the slider is stuck. */
  function frameInTime(name, low, high, title) {
    const state = traces.pens[name];
    state.clear();
    const box = boxOf(state);
    drawStuck(state.ctx, box);
    const y = leftAxis(state.ctx, box, low, high, title);
    const [from, to] = span().map((time) => 1e3 * time);
    return { ctx: state.ctx, box, x: lowerAxis(state.ctx, box, from, to, 'time, ms'), y };
  }

  /** Shade the times at which the slider is stuck. */
  function drawStuck(ctx, box) {
    const [from, to] = span();
    const x = (time) => box.left + ((time - from) / (to - from)) * (box.right - box.left);
    ctx.fillStyle = ink.stuck;
    for (const [begin, end] of rub.run.motion.stuck(from, Math.min(to, rub.run.time))) {
      ctx.fillRect(x(begin), box.top, Math.max(1, x(end) - x(begin)), box.bottom - box.top);
    }
  }

  /** Draw one column of a slider that pushes back, up to now; y takes its values. */
  function drawMotion(ctx, x, y, name) {
    const { motion, time } = rub.run;
    const times = motion.columns.time.values;
    const { values } = motion.columns[name];
    const phases = motion.columns.phase.values;
    const first = motion.columns.time.find(span()[0]);
    const last = motion.columns.time.find(time);
    const stride = Math.max(1, Math.ceil((last - first) / MOST_POINTS));
    ctx.strokeStyle = ink.ink;
    ctx.lineWidth = 1.5;
    ctx.lineJoin = 'round';
    ctx.beginPath();
    ctx.moveTo(x(1e3 * times[first]), y(values[first]));
    for (let i = first + 1; i <= last; i += 1) {
      const corner = phases[i] !== SLIP || phases[i - 1] !== SLIP; // where it turns, and both ends of a stick
      if (corner || i % stride === 0) ctx.lineTo(x(1e3 * times[i]), y(values[i]));
    }
    ctx.lineTo(x(1e3 * time), y(motion.at(name, time)));
    ctx.stroke();
  }

  /** Draw within a box what may leave it. */
  function clipped(ctx, box, draw) {
    ctx.save();
    ctx.beginPath();
    ctx.rect(box.left, box.top, box.right - box.left, box.bottom - box.top);
    ctx.clip();
    draw();
    ctx.restore();
  }

  /** Return the largest area on show of a contact, in um^2. */
  traces.topOf = ({ areaMean, areaStd }) => Math.max(1.25 * areaMean, areaMean + 4.5 * areaStd);
  traces.topArea = () => traces.topOf(rub.exact());

  function drawArea(seen) {
    const { areaMean, areaStd } = rub.exact();
    const { ctx, box, x, y } = frame('area', 0, traces.topArea(), 'real contact area, µm²');
    drawStack(ctx, box);
    drawExact(ctx, box, y, areaMean, areaStd, seen.areaMean);
    drawColumn(ctx, x, y, rub.run.trace.area);
  }

  function drawStack(ctx, box) {
    const { scale } = traces.pens.area;
    const [begin] = stretch();
    const columns = Math.max(1, Math.round((box.right - box.left) * scale));
    const spacing = rub.run.window / columns;
    const height = Math.max(1, Math.round((box.bottom - box.top) * scale));
    const { stack } = rub;
    if (
      stack.width !== columns ||
      stack.height !== height ||
      stack.spacing !== spacing ||
      stack.top !== traces.topArea()
    ) {
      stack.begin(columns, height, traces.topArea(), spacing);
    }
    const to = Math.floor(rub.run.reached / spacing) - 1;
    const from = Math.max(0, to - columns + 1);
    if (to < from) return;
    stack.until(from, to);
    /* On whole pixels of the screen: a seam shows where the ring's end meets its beginning otherwise. */
    const left = box.left + ((from * spacing - begin) / rub.run.window) * (box.right - box.left);
    const x = Math.round(left * scale) / scale;
    stack.paint(ctx, from, to, x, box.top, 1 / scale);
  }

  /** Return the largest count on show. */
  traces.topCount = () => {
    const { countMean, countStd } = rub.exact();
    return Math.ceil(Math.max(countMean + 4.5 * countStd, 1.3 * countMean, 2));
  };

  function drawCount(seen) {
    const { countMean, countStd } = rub.exact();
    const { ctx, box, x, y } = frame('count', 0, traces.topCount(), 'live junctions');
    drawExact(ctx, box, y, countMean, countStd, seen.countMean);
    drawSteps(ctx, x, y, rub.run.trace.count);
  }

  function drawForce(seen) {
    const { forceMean, forceStd } = rub.exact();
    const { motion } = rub.run;
    const top = rub.world.strength * traces.topArea() * 1e-3;
    if (motion) {
      const low = 1.1e-3 * motion.range.force[0];
      const { ctx, box, x, y } = frameInTime('force', low, Math.max(top, low + 1e-9), 'friction force, mN');
      clipped(ctx, box, () => drawMotion(ctx, x, (value) => y(value * 1e-3), 'force'));
      return;
    }
    const { ctx, box, x, y } = frame('force', 0, top, 'friction force, mN', forceStretch());
    const milli = (value) => y(value * 1e-3);
    drawExact(ctx, box, milli, forceMean, forceStd, seen.forceMean);
    drawColumn(ctx, x, milli, rub.run.trace.force, forceStretch());
  }

  function drawSlider(seen) {
    const { displacementMean, displacementStd } = rub.exact();
    const inTime = Boolean(rub.run.motion);
    const title = 'slider displacement, µm';
    const { ctx, box, x, y } = inTime
      ? frameInTime('slider', ...traces.reach(), title)
      : frame('slider', ...traces.reach(), title, longStretch());
    clipped(ctx, box, () => {
      if (inTime) {
        level(ctx, box, y(seen.displacementMean), ink.ink, [5, 4]);
        drawMotion(ctx, x, y, 'displacement');
      } else {
        drawExact(ctx, box, y, displacementMean, displacementStd, seen.displacementMean);
        drawColumn(ctx, x, y, rub.run.trace.displacement, longStretch());
        rub.swings.draw(ctx, box, x, longStretch());
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
  function drawVelocity() {
    const { motion, trace } = rub.run;
    const { speed } = rub.world;
    const reach = 4.5 * rub.exact().velocityStd;
    const [low, high] = motion ? motion.range.velocity : [-reach, reach];
    const [bottom, top] = [Math.min(1.1 * low, -0.02 * speed), Math.max(1.1 * high, 0.02 * speed)];
    const drive = speed < top ? '; dots: the drive' : '';
    const title = [`velocity of the slider, mm/s${drive}`, `velocity, mm/s${drive}`];
    const { ctx, box, x, y } = motion
      ? frameInTime('velocity', 1e-3 * bottom, 1e-3 * top, title)
      : frame('velocity', 1e-3 * bottom, 1e-3 * top, title, longStretch());
    const milli = (value) => y(value * 1e-3);
    clipped(ctx, box, () => {
      level(ctx, box, milli(speed), ink.second, [2, 3]);
      if (motion) drawMotion(ctx, x, milli, 'velocity');
      else drawColumn(ctx, x, milli, trace.velocity, longStretch());
    });
  }

  /** Draw all traces. */
  traces.draw = (seen) => {
    drawArea(seen);
    drawCount(seen);
    drawForce(seen);
    drawSlider(seen);
    drawVelocity();
  };

  /** Take over the canvases of these names. */
  traces.begin = (names) => {
    for (const name of names) traces.pens[name] = pen(document.getElementById(name));
  };

  traces.fit = () => {
    Object.values(traces.pens).forEach((state) => state.fit());
    rub.stack.forget();
  };

  Object.assign(traces, { stretch, longStretch, boxOf, level, clipped });
  rub.traces = traces;
})();
