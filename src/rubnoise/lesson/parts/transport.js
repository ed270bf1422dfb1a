/* Playing, stopping, one event at a time, how fast, and where in the run; by mouse, finger and keyboard. */
const { said } = rub.plot;
const SLOWEST = 0.5;
const FASTEST = 2000;
const SCRUB = 2000;
const find = (id) => document.getElementById(id);
const transport = {};

const paceAt = (step) => Number((SLOWEST * (FASTEST / SLOWEST) ** (step / 100)).toPrecision(2));
const stepOf = (pace) => Math.round((100 * Math.log(pace / SLOWEST)) / Math.log(FASTEST / SLOWEST));

/** Play where it stands, stop where it plays. */
transport.toggle = () => (rub.run.playing ? rub.run.pause() : rub.run.play());

/** Go on to the next event and say what it was. */
transport.step = () => {
  const event = rub.run.stepEvent();
  if (!event) return;
  if (event.row) rub.select(event.row.id);
  const what = event.row ? `${event.kind} of junction ${event.row.id}` : event.kind;
  find('status').textContent = `${what} at ${said(event.distance, 6)} µm`;
};

/** Change how fast it slides, in um a second of the clock on the wall. */
transport.pace = (pace) => {
  rub.run.pace = Math.min(FASTEST, Math.max(SLOWEST, pace));
  find('pace').value = stepOf(rub.run.pace);
  const lives = rub.run.pace / rub.exact().lifeMean;
  const slower = rub.world.speed / rub.run.pace;
  const beside = slower >= 1 ? `${said(slower, 2)} times slower` : `${said(1 / slower, 2)} times faster`;
  const often = said(lives, 2);
  const text = `${said(rub.run.pace, 2)} µm/s: ${often} ${often === '1' ? 'life' : 'lives'} a second, ${beside} than true`;
  find('pace-said').textContent = text;
  find('pace').setAttribute('aria-valuetext', text);
};

/** Show where the run is. */
transport.where = () => {
  find('scrubber').value = Math.round((SCRUB * rub.run.reached) / rub.run.end);
  const text = `${said(rub.run.reached, 5)} of ${said(rub.run.end, 5)} µm`;
  find('where').textContent = text;
};

function showPlaying() {
  find('play').textContent = rub.run.playing ? '❚❚ pause' : '▶ play';
  find('play').setAttribute('aria-pressed', String(rub.run.playing));
}

/* Keys for what is done most; none where text or numbers are typed. */
const KEYS = {
  k: () => transport.toggle(),
  e: () => transport.step(),
  '+': () => transport.pace(rub.run.pace * 1.5),
  '-': () => transport.pace(rub.run.pace / 1.5),
  b: () => rub.projector(),
  n: () => rub.card.move(1),
  p: () => rub.card.move(-1),
  0: () => rub.run.goTo(0),
  Escape: () => rub.select(-1),
};
const ON_STAGE = {
  ' ': () => transport.toggle(),
  ArrowRight: () => rub.card.move(1),
  ArrowLeft: () => rub.card.move(-1),
  Enter: () => transport.step(),
};

function press(event) {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const typing = event.target.matches('input, select, textarea, [contenteditable]');
  const act = event.target === find('stage') ? (ON_STAGE[event.key] ?? KEYS[event.key]) : !typing && KEYS[event.key];
  if (!act) return;
  event.preventDefault();
  act();
}

/** Connect buttons and keys. */
transport.begin = () => {
  find('play').addEventListener('click', transport.toggle);
  find('step').addEventListener('click', transport.step);
  find('rewind').addEventListener('click', () => rub.run.goTo(0));
  find('pace').addEventListener('input', () => transport.pace(paceAt(Number(find('pace').value))));
  find('scrubber').addEventListener('input', () => {
    rub.run.goTo((Number(find('scrubber').value) / SCRUB) * rub.run.end);
  });
  document.addEventListener('keydown', press);
  rub.on('playing', showPlaying);
  rub.on('settings', () => transport.pace(rub.run.pace));
  transport.pace(rub.run.pace);
  showPlaying();
};

rub.transport = transport;
