/* A strip to play with before the first lesson: a click lets a junction be born, and it lives its life. */
const { ink, Picture } = rub.plot;
const LIFE = 3; // s
const STEPS = 4; // of a life, one a click, where nothing may move
const MOST = 12;
const born = { lives: [] };
let pen = null;
let last = 0;

function drawLife(p, { place, age }) {
  const r = 0.3 * p.height;
  const [x, y, along] = [place * p.width, 0.5 * p.height, (2 * age - 1) * 2 * r];
  for (const middle of [x, x + along]) p.circle(middle, y, r, { colour: ink.second });
  p.fill((ctx) => rub.stage.lens(ctx, x + along / 2, y, r, along, 0), ink.exact);
}

function draw(p) {
  born.lives.forEach((life) => drawLife(p, life));
  const count = born.lives.length;
  p.heading(count ? `${count} alive` : 'click here', { left: 4, top: 16 });
}

function frame(now) {
  if (!pen?.canvas.isConnected) return;
  const seconds = Math.min(0.1, (now - last) / 1000);
  last = now;
  older(seconds / LIFE);
  pen.redraw();
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
  pen.redraw();
  if (calm || !still) return;
  last = performance.now();
  requestAnimationFrame(frame);
}

/** Take over the strip, wherever the page has one. */
born.begin = (canvas) => {
  pen = null;
  born.lives = [];
  if (!canvas) return;
  pen = new Picture(canvas, draw);
  canvas.addEventListener('click', (event) => bear(event.offsetX / canvas.clientWidth));
  canvas.addEventListener('keydown', (event) => {
    if (event.key !== 'Enter' && event.key !== ' ') return;
    event.preventDefault();
    bear(0.1 + 0.8 * Math.random());
  });
  pen.redraw();
};

rub.born = born;
