'use strict';
/* The slider from the side: a mass on a spring, pulled along by the surface that the drive moves to the right. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, pen, heading } = rub.plot;
  const COILS = 14;
  const MARKS = 36; // pixels between two marks of the surface
  const PHASES = ['slides', 'stuck', 'runs back over the surface'];
  const mass = { pen: null };

  /** Return the displacement in um, the way of the drive in um, and the phase. */
  function now() {
    const { motion, time, trace, ticksSeen, distance } = rub.run;
    if (motion) return [motion.at('displacement', time), rub.world.speed * time, motion.phaseAt(time)];
    return [trace.displacement[ticksSeen], distance, 0];
  }

  /** Draw the slider as it is now; it and the surface move on one scale. */
  mass.draw = () => {
    const { ctx, width, height } = mass.pen;
    const [place, way, phase] = now();
    const [low, high] = rub.traces.reach();
    const scale = (0.7 * width) / (high - low);
    const x = 0.16 * width + (Math.min(Math.max(place, low), high) - low) * scale;
    const floor = height - 14;
    mass.pen.clear();
    drawSurface(ctx, width, floor, way * scale);
    drawSpring(ctx, x, floor - 16);
    drawBlock(ctx, x, floor, phase === 1);
    heading(ctx, { left: Math.min(x + 30, width - 70), top: floor - 8 }, rub.run.motion ? PHASES[phase] : '');
  };

  function drawSurface(ctx, width, floor, shift) {
    ctx.strokeStyle = ink.second;
    ctx.lineWidth = 2;
    ctx.beginPath();
    ctx.moveTo(0, floor);
    ctx.lineTo(width, floor);
    for (let x = (shift % MARKS) - MARKS; x < width; x += MARKS) {
      ctx.moveTo(x, floor);
      ctx.lineTo(x - 6, floor + 9);
    }
    ctx.stroke();
  }

  function drawSpring(ctx, x, y) {
    const end = x - 22;
    ctx.strokeStyle = ink.quiet;
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.moveTo(4, y - 18);
    ctx.lineTo(4, y + 14);
    ctx.moveTo(4, y);
    for (let i = 1; i < COILS; i += 1) ctx.lineTo(4 + ((end - 4) * i) / COILS, y + (i % 2 ? -6 : 6));
    ctx.lineTo(end, y);
    ctx.stroke();
  }

  /* A stuck slider is filled and has teeth, so that you can see it without colour. */
  function drawBlock(ctx, x, floor, isStuck) {
    ctx.fillStyle = isStuck ? ink.second : ink.ground;
    ctx.strokeStyle = ink.ink;
    ctx.lineWidth = 2;
    ctx.beginPath();
    ctx.rect(x - 22, floor - 30, 44, 28);
    ctx.fill();
    ctx.stroke();
    if (!isStuck) return;
    ctx.beginPath();
    for (let i = -18; i <= 18; i += 6) {
      ctx.moveTo(x + i, floor - 3);
      ctx.lineTo(x + i, floor + 4);
    }
    ctx.stroke();
  }

  mass.begin = (canvas) => {
    mass.pen = pen(canvas);
  };

  mass.fit = () => mass.pen.fit();

  rub.mass = mass;
})();
