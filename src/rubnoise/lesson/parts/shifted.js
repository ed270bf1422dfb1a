'use strict';
/* The trace over itself: the real contact area, and the same curve moved on by a lag that the student chooses. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, pen, line, leftAxis, lowerAxis, heading, said } = rub.plot;
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

  /** Draw both curves, what they have in common shaded, and beside them each value over its partner. */
  shifted.draw = (seen) => {
    if (!shifted.pen.width) return;
    const { ctx } = shifted.pen;
    shifted.pen.clear();
    const box = rub.traces.boxOf(shifted.pen);
    const [from, to] = rub.traces.stretch();
    const y = leftAxis(ctx, box, 0, rub.traces.topArea(), TITLES);
    const x = lowerAxis(ctx, box, from, to, 'sliding distance, µm');
    drawShared(ctx, x, box, from, seen.areaMean);
    rub.traces.level(ctx, box, y(seen.areaMean), ink.ink, [5, 4]);
    rub.traces.clipped(ctx, box, () => {
      drawCurve(ctx, x, y, from, shifted.ticks(), ink.accent, 2.5);
      drawCurve(ctx, x, y, from, 0, ink.ink, 1.5);
    });
    drawPairs(seen.areaMean);
  };

  function drawCurve(ctx, x, y, from, ticks, colour, width) {
    const { trace, ticksSeen } = rub.run;
    const first = Math.max(0, Math.floor(from / trace.tick) - ticks);
    if (ticksSeen - ticks < first) return;
    ctx.strokeStyle = colour;
    ctx.lineWidth = width;
    ctx.lineJoin = 'round';
    line(
      ctx,
      first,
      ticksSeen - ticks,
      (i) => x((i + ticks) * trace.tick),
      (i) => y(trace.area[i]),
    );
  }

  /** Return whether both curves are on one side of the mean at a tick. */
  function agree(i, ticks, mean) {
    const { area } = rub.run.trace;
    return (area[i] - mean) * (area[i - ticks] - mean) > 0;
  }

  function drawShared(ctx, x, box, from, mean) {
    const { trace, ticksSeen } = rub.run;
    const ticks = shifted.ticks();
    ctx.fillStyle = ink.band;
    let begin = -1;
    for (let i = Math.max(ticks, Math.ceil(from / trace.tick)); i <= ticksSeen + 1; i += 1) {
      const isShared = i <= ticksSeen && agree(i, ticks, mean);
      if (isShared && begin < 0) begin = i;
      if (isShared || begin < 0) continue;
      ctx.fillRect(x(begin * trace.tick), box.top, x(i * trace.tick) - x(begin * trace.tick), box.bottom - box.top);
      begin = -1;
    }
  }

  /** Draw a dot for each value over the one a lag before, on equal axes. */
  function drawPairs(mean) {
    const { ctx, width, height } = shifted.pairs;
    if (!width) return;
    shifted.pairs.clear();
    const side = Math.min(width - 12, height - 40);
    const box = { left: 8, top: 18, right: 8 + side, bottom: 18 + side };
    const { trace, ticksSeen } = rub.run;
    const at = (area) => (Math.min(area, rub.traces.topArea()) / rub.traces.topArea()) * side;
    ctx.strokeStyle = ink.faint;
    ctx.lineWidth = 1;
    ctx.strokeRect(box.left, box.top, side, side);
    rub.traces.level(ctx, box, box.bottom - at(mean), ink.quiet, [5, 4]);
    ctx.fillStyle = ink.ink;
    ctx.globalAlpha = 0.5;
    const ticks = shifted.ticks();
    const stride = Math.max(1, Math.round((APART * rub.exact().lifeMean) / trace.tick));
    const last = ticksSeen - (ticksSeen % stride);
    for (let i = last, dots = 0; i >= ticks && dots < DOTS; i -= stride, dots += 1) {
      ctx.fillRect(box.left + at(trace.area[i - ticks]) - 1, box.bottom - at(trace.area[i]) - 1, 2.5, 2.5);
    }
    ctx.globalAlpha = 1;
    heading(ctx, box, 'area here');
    ctx.fillStyle = ink.quiet;
    ctx.textAlign = 'right';
    ctx.textBaseline = 'top';
    ctx.fillText('a lag before', box.right, box.bottom + 3);
  }

  /** Write the lag and, where that gives nothing away, how strongly the curves are correlated so far. */
  shifted.write = () => {
    const lives = `${said(shifted.lives, 3)} lives, ${said(shifted.lag(), 3)} µm`;
    const value = rub.readout.isOpen('seen') ? shifted.correlation() : NaN;
    find('lag-said').textContent = Number.isFinite(value) ? `${lives}: correlation ${said(value, 2)}` : lives;
    find('lag').setAttribute('aria-valuetext', lives);
  };

  /** Return the correlation of the trace with itself at the lag, about the mean so far; NaN before there is one. */
  shifted.correlation = () => {
    const { ticksSeen } = rub.run;
    const { lag, value } = rub.estimates.memory();
    if (ticksSeen * rub.run.trace.tick < 4 * rub.exact().lifeMean) return NaN;
    const step = lag[1];
    const i = Math.min(Math.floor(shifted.lag() / step), lag.length - 2);
    return value[i] + (shifted.lag() / step - i) * (value[i + 1] - value[i]);
  };

  shifted.begin = (canvas, pairs) => {
    Object.assign(shifted, { pen: pen(canvas), pairs: pen(pairs) });
    find('lag').value = LAG;
    find('lag').addEventListener('input', () => {
      shifted.lives = Number(find('lag').value);
      shifted.write();
      rub.emit('lag', shifted.lives);
    });
  };

  shifted.fit = () => {
    shifted.pen.fit();
    shifted.pairs.fit();
  };

  rub.shifted = shifted;
})();
