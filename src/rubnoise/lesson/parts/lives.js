'use strict';
/* Life-lines: a bar from birth to death for each junction, the line of now across them, and how many it crosses. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, pen, heading } = rub.plot;
  const LEFT = 46; // as the trace of the count below, so that a place is above itself
  const MARKED = 4; // px of a lane from which on births and deaths are marked
  const lives = { lanes: [], ends: [], rows: null };
  const counts = { seen: [], ticks: 0, trace: null };

  /** Give every row the lowest lane that is free at its birth. */
  function assign(rows) {
    if (lives.rows !== rows) Object.assign(lives, { rows, lanes: [], ends: [] });
    for (let i = lives.lanes.length; i < rows.length; i += 1) {
      let lane = lives.ends.findIndex((end) => end <= rows[i].birth);
      if (lane < 0) lane = lives.ends.length;
      lives.ends[lane] = rows[i].death;
      lives.lanes.push(lane);
    }
  }

  /** Draw the lives of the stretch on show, as far as they have been seen. */
  lives.draw = () => {
    const { ctx, width, height } = lives.pen;
    if (!width) return;
    lives.pen.clear();
    const { run } = rub;
    assign(run.rows);
    const box = { left: LEFT, top: 18, right: width - 8, bottom: height - 4 };
    const [from, to] = rub.traces.stretch();
    const x = (place) => box.left + ((place - from) / (to - from)) * (box.right - box.left);
    const { countMean, countStd } = rub.exact();
    const lane = (box.bottom - box.top) / Math.max(countMean + 2 * countStd, lives.ends.length);
    for (let i = run.after(from - run.longest); i < run.after(run.reached); i += 1) {
      const row = run.rows[i];
      if (row.death > from) drawLife(ctx, row, x, box.bottom - (lives.lanes[i] + 1) * lane, lane, from);
    }
    drawNow(ctx, x(run.distance), box);
  };

  function drawLife(ctx, row, x, top, lane, from) {
    const { distance, reached, selected } = rub.run;
    const isAlive = row.birth <= distance && row.death > distance;
    const [begin, end] = [x(Math.max(row.birth, from)), x(Math.min(row.death, reached))];
    const high = Math.max(1, 0.65 * lane);
    ctx.fillStyle = row.id === selected ? ink.accent : isAlive ? ink.exact : ink.quiet;
    ctx.globalAlpha = isAlive || row.id === selected ? 1 : 0.35;
    ctx.fillRect(begin, top, Math.max(1, end - begin), high);
    ctx.globalAlpha = 1;
    if (lane < MARKED) return;
    ctx.fillStyle = ink.birth;
    if (row.birth >= from) ctx.fillRect(begin, top - 1, 2, high + 2);
    ctx.fillStyle = ink.death;
    if (row.death <= reached) ctx.fillRect(end - 2, top - 1, 2, high + 2);
  }

  function drawNow(ctx, at, box) {
    const { length } = rub.run.living;
    ctx.strokeStyle = ink.ink;
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.moveTo(at, box.top);
    ctx.lineTo(at, box.bottom);
    ctx.stroke();
    heading(ctx, box, `${length} lives cross the line of now`);
  }

  /** Count the ticks passed since the last time, or all of them where the run has gone back or is another. */
  function update() {
    const { trace, ticksSeen } = rub.run;
    if (trace !== counts.trace || ticksSeen + 1 < counts.ticks) Object.assign(counts, { seen: [], ticks: 0, trace });
    for (; counts.ticks <= ticksSeen; counts.ticks += 1) {
      const count = trace.count[counts.ticks];
      counts.seen[count] = (counts.seen[count] ?? 0) + 1;
    }
  }

  /** Return the probabilities of Poisson's law up to a number. */
  lives.poisson = (mean, most) => {
    const found = [Math.exp(-mean)];
    for (let n = 1; n <= most; n += 1) found.push((found[n - 1] * mean) / n);
    return found;
  };

  /** Draw how often each count has been met so far, on the scale of the trace beside it, and Poisson's bars. */
  lives.drawCounts = () => {
    const { ctx, width, height } = counts.pen;
    if (!width) return;
    counts.pen.clear();
    update();
    const box = { left: 4, top: 18, right: width - 4, bottom: height - 18 };
    const top = rub.traces.topCount();
    const isRandom = rub.world.births === 'poisson';
    const law = isRandom ? lives.poisson(rub.exact().countMean, top) : [];
    const peak = isRandom ? 1.4 * Math.max(...law) : 1;
    const high = (box.bottom - box.top) / top;
    const x = (share) => Math.min(1, share / peak) * (box.right - box.left);
    const y = (count) => Math.max(box.top, box.bottom - (count + 0.5) * high);
    ctx.fillStyle = ink.quiet;
    ctx.strokeStyle = ink.exact;
    ctx.lineWidth = 1.5;
    for (let n = 0; n <= top; n += 1) {
      const tall = Math.min(high, box.bottom - y(n));
      ctx.globalAlpha = 0.45;
      ctx.fillRect(box.left, y(n), x((counts.seen[n] ?? 0) / counts.ticks), Math.max(1, tall - 0.5));
      ctx.globalAlpha = 1;
      if (isRandom && !rub.readout.veiled()) outline(ctx, box.left + x(law[n]), box.left, y(n), tall);
    }
    heading(ctx, box, isRandom && !rub.readout.veiled() ? ['how often, and Poisson’s law', 'Poisson'] : 'how often');
  };

  /** Draw the end of a bar and its two long sides as far as they do not hide the bars seen. */
  function outline(ctx, end, left, top, tall) {
    ctx.beginPath();
    ctx.moveTo(Math.max(left, end - 5), top);
    ctx.lineTo(end, top);
    ctx.lineTo(end, top + tall);
    ctx.lineTo(Math.max(left, end - 5), top + tall);
    ctx.stroke();
  }

  lives.begin = (canvas, beside) => {
    lives.pen = pen(canvas);
    counts.pen = pen(beside);
  };

  lives.fit = () => {
    lives.pen.fit();
    counts.pen.fit();
  };

  lives.counts = counts;
  rub.lives = lives;
})();
