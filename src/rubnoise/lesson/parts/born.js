'use strict';
/* A strip to play with before the first lesson: a click lets a junction be born, and it lives its life. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink } = rub.plot;
  const LIFE = 3; // s
  const STEPS = 4; // of a life, one a click, where nothing may move
  const MOST = 12;
  const born = { lives: [] };
  let pen = null;
  let last = 0;

  function circle(ctx, x, y, r) {
    ctx.beginPath();
    ctx.arc(x, y, r, 0, 2 * Math.PI);
  }

  function drawLife({ place, age }) {
    const { ctx, height } = pen;
    const r = 0.3 * height;
    const [x, y] = [place * pen.width, 0.5 * height];
    const moved = x + (2 * age - 1) * 2 * r;
    ctx.strokeStyle = ink.second;
    ctx.lineWidth = 1.5;
    for (const middle of [x, moved]) {
      circle(ctx, middle, y, r);
      ctx.stroke();
    }
    ctx.save();
    circle(ctx, x, y, r);
    ctx.clip();
    circle(ctx, moved, y, r);
    ctx.fillStyle = ink.exact;
    ctx.fill();
    ctx.restore();
  }

  function draw() {
    pen.clear();
    born.lives.forEach(drawLife);
    const count = born.lives.length;
    rub.plot.heading(pen.ctx, { left: 4, top: 16 }, count ? `${count} alive` : 'click here');
  }

  function frame(now) {
    if (!pen?.canvas.isConnected) return;
    const seconds = Math.min(0.1, (now - last) / 1000);
    last = now;
    older(seconds / LIFE);
    draw();
    if (born.lives.length) requestAnimationFrame(frame);
  }

  function older(part) {
    born.lives = born.lives.map(({ place, age }) => ({ place, age: age + part })).filter(({ age }) => age < 1);
  }

  function bear(place) {
    const calm = rub.stage.calm;
    if (calm) older(1 / STEPS);
    const still = born.lives.length === 0;
    if (born.lives.length < MOST) born.lives.push({ place, age: calm ? 1 / STEPS : 0 });
    draw();
    if (calm || !still) return;
    last = performance.now();
    requestAnimationFrame(frame);
  }

  /** Take over the strip, wherever the page has one. */
  born.begin = (canvas) => {
    pen = null;
    born.lives = [];
    if (!canvas) return;
    pen = rub.plot.pen(canvas);
    canvas.addEventListener('click', (event) => bear(event.offsetX / canvas.clientWidth));
    canvas.addEventListener('keydown', (event) => {
      if (event.key !== 'Enter' && event.key !== ' ') return;
      event.preventDefault();
      bear(0.1 + 0.8 * Math.random());
    });
    draw();
  };

  rub.born = born;
})();
