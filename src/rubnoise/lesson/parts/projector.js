'use strict';
/* For a class in front of a projector: larger type, and lines that can be seen from the last row. */
(() => {
  const rub = (globalThis.rub ??= {});
  const find = (id) => document.getElementById(id);
  const projector = {};

  /** Turn it on or off. */
  projector.toggle = () => {
    const isOn = document.documentElement.classList.toggle('projector');
    find('projector').setAttribute('aria-pressed', String(isOn));
    rub.fitAll();
  };

  projector.begin = () => find('projector').addEventListener('click', projector.toggle);

  rub.projector = projector;
})();
