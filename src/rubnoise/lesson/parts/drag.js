/* Numbers in a sentence that can be dragged, or turned with arrows: each sets a control. */
const PIXELS = 160; // of a drag that changes a number by a factor of ten
const KEYS = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 5, PageDown: -5 };
const STEP = 1.05;

/* What it is called, its value now, its limits, the settings of another value, and how it is written. */
const NUMBERS = {
  meanCount: {
    name: 'mean number of junctions',
    value: () => rub.world.meanCount,
    limits: [1, 200],
    settings: (meanCount) => ({ meanCount: Math.max(1, Math.round(meanCount)) }),
    text: (value) => rub.plot.said(value, 3),
  },
  /* At one number of junctions the mean area goes with the square of the diameter. */
  diameter: {
    name: 'diameter',
    value: () => rub.exact().diameter,
    limits: [0.5, 100],
    settings: (diameter) => ({ meanArea: rub.world.meanArea * (diameter / rub.exact().diameter) ** 2 }),
    text: (value) => `${rub.plot.said(value, 3)} µm`,
  },
  speed: {
    name: 'sliding speed',
    value: () => rub.world.speed,
    limits: [50, 1e6],
    settings: (speed) => ({ speed: Number(speed.toPrecision(3)) }),
    text: (value) => `${rub.plot.said(value / 1000, 3)} mm/s`,
  },
};

/** Return a number for a sentence, as HTML. */
const number = (key) =>
  `<span class="drag" role="slider" tabindex="0" data-drag="${key}" aria-label="${NUMBERS[key].name}"></span>`;

function turn(key, value) {
  const { limits, settings } = NUMBERS[key];
  rub.set(settings(Math.min(limits[1], Math.max(limits[0], value))), { restart: false });
}

/** Write the numbers of a part of the page. */
function write(root) {
  for (const element of root.querySelectorAll('[data-drag]')) {
    const { value, limits, text } = NUMBERS[element.dataset.drag];
    const now = value();
    element.textContent = text(now);
    const [valuemin, valuemax] = limits;
    const told = { valuenow: Number(now.toPrecision(4)), valuemin, valuemax, valuetext: text(now) };
    for (const [name, each] of Object.entries(told)) element.setAttribute(`aria-${name}`, each);
  }
}

function begin(root) {
  let held = null;
  const of = (event) => event.target.closest?.('[data-drag]');
  const take = (event) => {
    const element = of(event);
    if (!element) return false;
    event.preventDefault();
    element.focus();
    held = { key: element.dataset.drag, from: event.clientX, value: NUMBERS[element.dataset.drag].value() };
    return true;
  };
  rub.dragging(root, take, (event) => turn(held.key, held.value * 10 ** ((event.clientX - held.from) / PIXELS)));
  root.addEventListener('keydown', (event) => {
    const element = of(event);
    if (!element || !(event.key in KEYS)) return;
    event.preventDefault();
    const now = NUMBERS[element.dataset.drag].value();
    const wanted = now * STEP ** KEYS[event.key];
    const whole = element.dataset.drag === 'meanCount' && Math.abs(wanted - now) < 1;
    turn(element.dataset.drag, whole ? now + Math.sign(KEYS[event.key]) : wanted);
  });
}

rub.drag = { number, write, begin };
