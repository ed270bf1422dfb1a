'use strict';
/* A slider that hops, from the side: hills that pass under its foot, and how high the foot was on the way. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, pen, line, leftAxis, lowerAxis, heading } = rub.plot;
  const REACH = 5; // of c, to either side of the foot
  const LOW = -3; // of s0: the lowest that the stage shows
  const HIGH = 6;
  const LEG = 84; // pixels: longer than most hills are high, so that only the foot meets them
  const TOP = 22; // pixels for the title
  const SHOWN = 16; // of c, in the trace
  const TITLES = ['hills pass to the right under the foot of the slider; filled: what it touches', 'hills and slider'];
  const hop = { pen: null };

  /** Draw the stage: hills that the drive moves to the right, and the slider on its foot. */
  hop.stage = ({ ctx, width, height }) => {
    const { flight, distance } = rub.run;
    const scale = width / (2 * REACH);
    const x = (off) => 0.5 * width - off * scale;
    const z = flight.heightAt(distance);
    const high = Math.max(HIGH, z + 4.5);
    const y = (level) => TOP + ((high - level) / (high - LOW)) * (height - TOP);
    const hills = near(flight, distance / flight.length);
    ground(ctx, { width, height, x, y, scale }, hills);
    for (const hill of hills) if (hill.top - hill.off ** 2 > z) touched(ctx, hill, z, x, y);
    body(ctx, x(0), y(z), Math.min(0.2 * width, 90));
    heading(ctx, { left: 8, top: TOP, right: width }, TITLES);
  };

  /** Return the summits that are seen: how far ahead of the foot they are, in c, and how high, in s0. */
  function near(flight, place) {
    const { summits } = flight;
    const [first, last] = summits.between(place - rub.flight.SIDE, place + rub.flight.SIDE);
    const found = [];
    for (let i = first; i < last; i += 1) {
      const [off, top] = [summits.place.values[i] - place, summits.height.values[i]];
      if (top > LOW && Math.abs(off) < REACH + Math.sqrt(top - LOW)) found.push({ off, top });
    }
    return found;
  }

  function ground(ctx, { width, height, x, y, scale }, hills) {
    const levels = new Float64Array(Math.ceil(width) + 1).fill(LOW);
    for (const { off, top } of hills) {
      const half = Math.sqrt(top - LOW) * scale;
      const last = Math.min(levels.length - 1, Math.floor(x(off) + half));
      for (let i = Math.max(0, Math.ceil(x(off) - half)); i <= last; i += 1)
        levels[i] = Math.max(levels[i], top - ((i - x(off)) / scale) ** 2);
    }
    ctx.beginPath();
    ctx.moveTo(0, height);
    levels.forEach((level, i) => ctx.lineTo(i, y(level)));
    ctx.lineTo(width, height);
    ctx.closePath();
    ctx.fillStyle = ink.faint;
    ctx.fill();
    ctx.strokeStyle = ink.quiet;
    ctx.lineWidth = 1.2;
    ctx.stroke();
  }

  /** Fill the part of a hill that the foot has pressed in. */
  function touched(ctx, { off, top }, z, x, y) {
    const half = Math.sqrt(top - z);
    ctx.beginPath();
    for (let i = -20; i <= 20; i += 1) ctx.lineTo(x(off + (half * i) / 20), y(top - (half * (i / 20)) ** 2));
    ctx.closePath();
    ctx.fillStyle = rub.plot.colourOf(Math.min(1, (top - off * off - z) / 3));
    ctx.fill();
  }

  function body(ctx, x, y, wide) {
    ctx.fillStyle = ctx.strokeStyle = rub.run.flight.touchesAt(rub.run.distance) ? ink.second : ink.accent;
    ctx.lineWidth = 2;
    ctx.strokeRect(x - 0.5 * wide, y - LEG - 24, wide, 24);
    ctx.beginPath();
    ctx.moveTo(x - 5, y - LEG);
    ctx.lineTo(x, y);
    ctx.lineTo(x + 5, y - LEG);
    ctx.closePath();
    ctx.fill();
  }

  /** Draw the trace of the separation, with flights shaded, as far as the run has come. */
  hop.draw = () => {
    const { flight, distance } = rub.run;
    if (!flight || !hop.pen.width) return;
    hop.pen.clear();
    const { ctx, width, height } = hop.pen;
    const box = { left: 46, top: 18, right: width - 10, bottom: height - 20 };
    const { place, z, touching } = flight.columns;
    const last = flight.at(distance);
    const from = Math.max(0, distance / flight.length - SHOWN);
    const first = Math.max(0, place.find(from));
    const [low, high] = [LOW * flight.height, topOf(z, first, last) * flight.height];
    const y = leftAxis(ctx, box, low, high, ['separation, µm; shaded: apart', 'separation, µm']);
    const um = flight.length;
    const x = lowerAxis(ctx, box, from * um, (from + SHOWN) * um, 'sliding distance, µm');
    ctx.fillStyle = ink.stuck;
    for (let i = first; i < last; i += 1) {
      if (touching.values[i]) continue;
      const begun = i;
      while (i < last && !touching.values[i]) i += 1;
      const left = Math.max(box.left, x(place.values[begun] * um));
      ctx.fillRect(left, box.top, Math.max(1, x(place.values[i] * um) - left), box.bottom - box.top);
    }
    ctx.strokeStyle = ink.ink;
    ctx.lineWidth = 1.5;
    const across = (i) => Math.max(box.left, x(place.values[i] * um));
    line(ctx, first, last, across, (i) => y(z.values[i] * flight.height));
  };

  /* In steps, so that the axis stands still for a while. */
  function topOf(z, first, last) {
    let top = HIGH;
    for (let i = first; i <= last; i += 1) while (z.values[i] > top) top *= 1.5;
    return top;
  }

  hop.begin = (canvas) => {
    hop.pen = pen(canvas);
  };

  hop.fit = () => hop.pen.fit();

  rub.hop = hop;
})();
