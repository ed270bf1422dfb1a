/* The page comes to life: parts are connected, and every frame slides on and is drawn. */
const find = (id) => document.getElementById(id);
const { pictures, Picture, colourOf, said } = rub.plot;
let dirty = true;
let last = 0;
let shownAt = 0;

/** Show pictures below the stage by name, with a space between (none: the side view), and fold the others away. */
rub.show = (names) => {
  const wanted = (names || 'section').split(' ');
  const places = wanted.map((name) => find(`panel-${name}`) ?? find('panel'));
  for (const name of wanted) rub.panels.open(name);
  for (const other of document.querySelectorAll('#pictures figure'))
    other.classList.toggle('shown', places.includes(other));
  fold(true);
  pin();
  /* A jump and not a glide: the stage may not leave the screen on the way. */
  for (const place of [...places.reverse(), find('panel-stage')]) place.scrollIntoView({ block: 'nearest' });
};

/* How much of a phone's screen the pictures take, below which the lessons go on. */
const pin = () => {
  const heights = { pinned: 'pictures', 'stage-end': 'panel-stage', transport: 'transport' };
  for (const [name, id] of Object.entries(heights))
    document.documentElement.style.setProperty(`--${name}`, `${find(id).offsetHeight}px`);
};

/** Fold the traces that no lesson shows now, or unfold all of them. */
function fold(away) {
  find('pictures').classList.toggle('folded', away);
  find('unfold').setAttribute('aria-expanded', String(!away));
  find('unfold').textContent = away ? 'all traces' : 'fewer traces';
}

function frame(now) {
  const seconds = Math.min(0.1, (now - last) / 1000);
  last = now;
  rub.run.advance(seconds);
  if (dirty || rub.run.playing || rub.run.goal >= 0) draw(now);
  requestAnimationFrame(frame);
}

function draw(now) {
  const seen = rub.run.moments();
  for (const each of pictures) if (!each.slow) each.redraw(seen);
  if (!rub.run.playing || now - shownAt > 200) showSeen(now, seen);
  dirty = false;
}

/* Text changes five times a second: often enough to follow, seldom enough to read. */
function showSeen(now, seen) {
  shownAt = now;
  rub.readout.seen(seen);
  rub.transport.where();
  rub.card.refresh();
  for (const each of pictures) if (each.slow) each.redraw(seen);
  rub.shifted.write();
}

/** Fit all pictures to their places, and draw them there at once: a finger may be on one before the next frame. */
rub.fitAll = () => {
  rub.plot.readTheme();
  for (const each of pictures) {
    each.fit();
    each.fitted();
  }
  drawLegend();
  pin();
  shownAt = -Infinity;
  draw(performance.now());
};

/** Turn larger type for a class in front of a projector on or off. */
rub.projector = () => {
  const isOn = document.documentElement.classList.toggle('projector');
  find('projector').setAttribute('aria-pressed', String(isOn));
  rub.fitAll();
};

const legend = new Picture(find('legend'), (p) => {
  for (let i = 0; i < p.width; i += 1) p.shade(i, i + 1.5, colourOf(i / p.width), { top: 0, bottom: p.height });
});

function drawLegend() {
  legend.fit();
  legend.redraw();
  find('legend-top').textContent = `${said(rub.stage.largest(), 3)} µm²`;
}

function settingsChanged() {
  rub.readout.exact();
  rub.stage.measure();
  drawLegend();
  rub.card.write();
  find('replaying').hidden = !rub.replaying;
  find('pictures').classList.toggle('hopping', Boolean(rub.run.flight));
  find('key-stuck').hidden = !rub.run.motion;
  find('sketch').hidden = rub.world.pulse === 'lens';
  dirty = true;
}

function begin() {
  rub.begin(JSON.parse(find('data').textContent));
  rub.plot.readTheme();
  rub.run.renew({ keep: false });
  const calm = matchMedia('(prefers-reduced-motion: reduce)');
  rub.stage.calm = calm.matches;
  rub.stage.begin();
  rub.swings.begin(find('slider'));
  rub.drag.begin(find('lessons'));
  rub.shifted.begin();
  rub.reading.begin();
  rub.readout.begin(find('numbers'));
  rub.knobs.begin(find('knobs'));
  rub.panels.begin();
  rub.transport.begin();
  find('projector').addEventListener('click', rub.projector);
  const unfold = () => fold(!find('pictures').classList.contains('folded'));
  find('unfold').addEventListener('click', unfold);
  rub.sound.begin();
  rub.on('settings', settingsChanged);
  for (const event of ['select', 'reset', 'tick', 'density', 'veil', 'lag', 'reading']) {
    rub.on(event, () => {
      dirty = true;
    });
  }
  rub.followFragment();
  rub.knobs.show();
  settingsChanged();
  rub.fitAll();
  new ResizeObserver(rub.fitAll).observe(find('pictures'));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', rub.fitAll);
  rub.emit('ready', rub.lesson);
  if (!calm.matches) rub.run.play();
  requestAnimationFrame((now) => {
    last = now;
    frame(now);
  });
}

if (document.readyState === 'loading') document.addEventListener('DOMContentLoaded', begin);
else begin();
