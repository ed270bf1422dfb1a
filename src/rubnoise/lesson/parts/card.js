'use strict';
/* One junction's life: its row, its numbers, its curve. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, pen, said, line, leftAxis, lowerAxis } = rub.plot;
  const card = {};

  /** Choose a junction by its row number; -1 chooses none. */
  rub.select = (id) => {
    const known = rub.run.rows.some((row) => row.id === id);
    rub.run.selected = known ? id : -1;
    rub.stack.forget();
    card.write();
    card.status.textContent = known ? `junction ${id}: diameter ${said(rub.run.rows[id].diameter, 6)} µm` : '';
    rub.emit('select', known ? rub.run.rows[id] : null);
  };

  /** Choose the next live junction after the one that is chosen, or the one before. */
  card.move = (step) => {
    const { living } = rub.run;
    if (rub.run.flight || !living.length) return;
    const at = living.findIndex((row) => row.id === rub.run.selected);
    rub.select(living[at < 0 ? 0 : (at + step + living.length) % living.length].id);
  };

  const chosen = () => rub.run.rows[rub.run.selected];

  const halfOf = (row) => rub.model.halfLife(row.diameter, row.offset);

  /** Return the area of a row at an age, in um^2. */
  const areaAt = (row, age) => rub.run.trace.pulse.area(age, row.diameter, row.offset);

  /** Return the mean area of a row over its life, in um^2. */
  function meanArea(row) {
    const { pulse } = rub.run.trace;
    if (!pulse.between) return pulse.lifeMean * row.diameter ** 2;
    const life = 2 * halfOf(row);
    const edges = rub.numbers.evenly(0, life, 64);
    return edges.slice(1).reduce((sum, to, i) => sum + pulse.between(edges[i], to, row.diameter, row.offset), 0) / life;
  }

  /** Return the numbers of a row as label, value and unit. */
  function numbersOf(row) {
    const { distance } = rub.run;
    const numbers = [
      ['row', String(row.id), ''],
      ['born at', said(row.birth, 6), 'µm'],
      ['dies at', said(row.death, 6), 'µm'],
      ['diameter', said(row.diameter, 6), 'µm'],
      ['life', said(2 * halfOf(row), 6), 'µm'],
      ['largest area', said(areaAt(row, halfOf(row)), 6), 'µm²'],
      ['mean area', said(meanArea(row), 6), 'µm²'],
      ['area now', said(areaAt(row, distance - row.birth), 6), 'µm²'],
    ];
    if (row.offset) numbers.splice(4, 0, ['misses the centre by', said(Math.abs(row.offset), 6), 'µm']);
    return numbers.filter(([label]) => label !== 'mean area' || !rub.readout.veiled());
  }

  /** Write the numbers of the chosen junction. */
  card.write = () => {
    const row = chosen();
    card.panel.hidden = !row;
    card.hint.hidden = Boolean(row);
    if (!row) return;
    const cells = numbersOf(row).map(([label, value, unit]) => `<dt>${label}</dt><dd>${value} ${unit}</dd>`);
    card.list.innerHTML = cells.join('');
    card.pen.fit();
    card.draw();
  };

  /** Draw the curve of the chosen life, and where on it the junction is. */
  card.draw = () => {
    const row = chosen();
    if (!row) return;
    const { ctx, width, height } = card.pen;
    card.pen.clear();
    const box = { left: 40, top: 18, right: width - 8, bottom: height - 18 };
    const y = leftAxis(
      ctx,
      box,
      0,
      1.1 * Math.max(rub.stage.largest(), 0.25 * Math.PI * row.diameter ** 2),
      'area of this junction, µm²',
    );
    const life = 2 * halfOf(row);
    const x = lowerAxis(ctx, box, 0, life, 'distance since birth, µm');
    ctx.strokeStyle = ink.accent;
    ctx.lineWidth = 2;
    const along = (i) => (i / 80) * life;
    line(
      ctx,
      0,
      80,
      (i) => x(along(i)),
      (i) => y(areaAt(row, along(i))),
    );
    const age = rub.run.distance - row.birth;
    if (age < 0 || age > life) return;
    ctx.fillStyle = ink.ink;
    ctx.beginPath();
    ctx.arc(x(age), y(areaAt(row, age)), 4.5, 0, 2 * Math.PI);
    ctx.fill();
  };

  /** Keep the area that changes from moment to moment up to date. */
  card.refresh = () => {
    const row = chosen();
    if (!row) return;
    const cells = card.list.querySelectorAll('dd');
    cells[cells.length - 1].textContent =
      `${said(areaAt(row, rub.run.distance - row.birth), 6)} µm²`;
  };

  card.begin = (panel, hint, status) => {
    Object.assign(card, {
      panel,
      hint,
      status,
      list: panel.querySelector('dl'),
      pen: pen(panel.querySelector('canvas')),
    });
  };

  rub.card = card;
})();
