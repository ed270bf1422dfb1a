'use strict';
/* The stage: two surfaces seen from above, one at rest, one sliding to the right, and the circles that meet. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, colourOf } = rub.plot;
  const ROOMY = 9; // area of the stage over that of the circles that are alive on average
  const FEW = 6; // junctions alive: so few that a line through the middle would miss most of them
  const stage = { pen: null, calm: false, scale: 1 };
  let scale = 1; // pixels in a um
  let wide = 1;
  let high = 1;

  const { placeOf } = rub.places;
  const place = [0, 0];

  /** Return how far the centres of a row are apart along the motion, negative before mid-life, in um. */
  stage.along = (row) => rub.run.distance - row.birth - rub.model.halfLife(row.diameter, row.offset);

  /** Measure the stage: how many um it shows. */
  function measure() {
    const { countMean, contact } = rub.exact();
    const area = ROOMY * Math.max(6, countMean) * 0.25 * Math.PI * contact.diameter ** 2;
    scale = Math.sqrt((stage.pen.width * stage.pen.height) / area);
    stage.scale = scale;
    const [before, beforeHigh] = [wide, high];
    wide = stage.pen.width / scale;
    high = stage.pen.height / scale;
    if (wide !== before || high !== beforeHigh) rub.places.within(wide, high);
  }

  /** Draw both surfaces and every junction as it is now. */
  stage.draw = () => {
    const { ctx } = stage.pen;
    stage.pen.clear();
    if (rub.run.flight) return rub.hop.stage(stage.pen);
    drawGrain(ctx);
    ctx.lineWidth = 1;
    drawComing(ctx);
    for (const row of rub.run.living) drawJunction(ctx, row);
    drawGone(ctx);
    drawSelected(ctx);
    drawCut(ctx);
  };

  /** Return where the cut of the side view goes, in um: through the chosen junction, one of few, or the middle. */
  stage.cut = () => {
    const row = chosen() ?? (rub.exact().countMean < FEW ? rub.run.living[0] : undefined);
    return row ? placeOf(row, place)[1] : 0.5 * high;
  };

  function drawCut(ctx) {
    if (!rub.section.pen.width) return;
    const y = Math.round(stage.cut() * scale);
    ctx.strokeStyle = ink.ink;
    ctx.setLineDash([2, 5]);
    ctx.beginPath();
    ctx.moveTo(0, y);
    ctx.lineTo(stage.pen.width, y);
    ctx.stroke();
    ctx.setLineDash([]);
  }

  /** Return the rows whose circles are in view: alive, about to meet, or just parted. */
  stage.pairs = () => {
    const { run } = rub;
    const reach = 0.5 * rub.exact().contact.diameter;
    const rows = run.rows.slice(run.after(run.distance - run.longest - reach), run.after(run.distance + reach));
    return rows.filter((row) => row.death + reach > run.distance);
  };

  /* A few strokes of either surface, so that the sliding is seen where nothing meets. */
  function drawGrain(ctx) {
    const shift = (rub.run.distance * scale) % 48;
    ctx.strokeStyle = ink.faint;
    ctx.lineWidth = 1;
    ctx.beginPath();
    for (let y = 10, row = 0; y < stage.pen.height; y += 22, row += 1) {
      const moves = row % 2 === 0;
      for (let x = -48 + ((row * 31) % 48) + (moves ? shift : 0); x < stage.pen.width; x += 48) {
        ctx.moveTo(x, y);
        ctx.lineTo(x + (moves ? 14 : 4), y);
      }
    }
    ctx.stroke();
  }

  /** Draw the pair of circles of a row at the offset of their centres, in pixels of the page. */
  function drawPair(ctx, row, offset) {
    placeOf(row, place);
    const [x, y, radius] = [place[0] * scale, place[1] * scale, 0.5 * row.diameter * scale];
    const [along, across] = [0.5 * offset * scale, 0.5 * row.offset * scale];
    ctx.strokeStyle = ink.quiet;
    circle(ctx, x - along, y - across, radius);
    ctx.strokeStyle = ink.second;
    circle(ctx, x + along, y + across, radius);
  }

  function circle(ctx, x, y, radius) {
    ctx.beginPath();
    ctx.arc(x, y, radius, 0, 2 * Math.PI);
    ctx.stroke();
  }

  function drawJunction(ctx, row) {
    const offset = stage.along(row);
    const area = rub.run.trace.pulse.area(rub.run.distance - row.birth, row.diameter, row.offset);
    placeOf(row, place);
    ctx.fillStyle = colourOf(area / largest());
    lens(ctx, place[0] * scale, place[1] * scale, 0.5 * row.diameter * scale, offset * scale, row.offset * scale);
    drawPair(ctx, row, offset);
    if (rub.run.distance - row.birth < 0.15 * row.diameter) mark(ctx, row, ink.birth, offset);
    else if (row.death - rub.run.distance < 0.15 * row.diameter) mark(ctx, row, ink.death, offset);
  }

  /** Fill the overlap of two circles whose centres are so far apart, along the motion and across it. */
  function lens(ctx, x, y, radius, along, across) {
    const half = Math.acos(Math.min(1, Math.hypot(along, across) / (2 * radius)));
    const turn = Math.atan2(across, along);
    ctx.beginPath();
    ctx.arc(x - along / 2, y - across / 2, radius, turn - half, turn + half);
    ctx.arc(x + along / 2, y + across / 2, radius, turn + Math.PI - half, turn + Math.PI + half);
    ctx.fill();
  }

  /* Births and deaths have a sign of their own beside the colour: a ring, and a cross. */
  function mark(ctx, row, colour, offset) {
    const [x, y] = [place[0] * scale, place[1] * scale];
    ctx.strokeStyle = colour;
    ctx.lineWidth = 2;
    if (offset < 0) circle(ctx, x, y, 7);
    else cross(ctx, x, y, 5);
    ctx.lineWidth = 1;
  }

  function cross(ctx, x, y, size) {
    ctx.beginPath();
    ctx.moveTo(x - size, y - size);
    ctx.lineTo(x + size, y + size);
    ctx.moveTo(x - size, y + size);
    ctx.lineTo(x + size, y - size);
    ctx.stroke();
  }

  /* Circles that are about to meet come into view, those that have parted fade. */
  function drawComing(ctx) {
    const { run } = rub;
    const reach = 0.5 * rub.exact().contact.diameter;
    for (let i = run.after(run.distance); i < run.rows.length && run.rows[i].birth < run.distance + reach; i += 1) {
      const row = run.rows[i];
      ctx.globalAlpha = 0.6 * (1 - (row.birth - run.distance) / reach);
      drawPair(ctx, row, stage.along(row));
    }
    ctx.globalAlpha = 1;
  }

  function drawGone(ctx) {
    const { run } = rub;
    const reach = 0.5 * rub.exact().contact.diameter;
    for (let i = run.after(run.distance - run.longest - reach); i < run.rows.length; i += 1) {
      const row = run.rows[i];
      if (row.birth > run.distance) break;
      const since = run.distance - row.death;
      if (since < 0 || since > reach) continue;
      ctx.globalAlpha = 0.6 * (1 - since / reach);
      drawPair(ctx, row, stage.along(row));
    }
    ctx.globalAlpha = 1;
  }

  const chosen = () => rub.run.living.find((each) => each.id === rub.run.selected);

  function drawSelected(ctx) {
    const row = chosen();
    if (!row) return;
    placeOf(row, place);
    ctx.strokeStyle = ink.accent;
    ctx.lineWidth = 3;
    const half = (apart) => 0.5 * (Math.abs(apart) + row.diameter) * scale + 4;
    ctx.beginPath();
    ctx.ellipse(
      place[0] * scale,
      place[1] * scale,
      half(stage.along(row)),
      half(row.offset),
      0,
      0,
      2 * Math.PI,
    );
    ctx.stroke();
    ctx.lineWidth = 1;
  }

  /** Return the area in um^2 at the upper end of the colours: full overlap of a junction as large as few are. */
  function largest() {
    const { mean, std } = rub.exact().contact.sizes;
    return 0.25 * Math.PI * (mean + 2 * std) ** 2;
  }

  /** Return the live row whose circles hold a point of the stage, the one whose middle is nearest; or null. */
  stage.rowAt = (x, y) => {
    if (rub.run.flight) return null;
    let found = null;
    let least = Infinity;
    for (const row of rub.run.living) {
      placeOf(row, place);
      const away = Math.hypot(x / scale - place[0], y / scale - place[1]);
      if (away < least && away < Math.max(row.diameter, 14 / scale)) [found, least] = [row, away];
    }
    return found;
  };

  /** Return where a live row is on the stage, in pixels of the page from its upper left corner. */
  stage.pointOf = (row) => placeOf(row, place).map((value) => value * scale * stage.pen.zoom);

  /** Take over the canvas; a click chooses a junction. */
  stage.begin = (canvas) => {
    stage.pen = rub.plot.pen(canvas);
    rub.on('reset', () => rub.places.within(wide, high));
    canvas.addEventListener('click', (event) => {
      const box = canvas.getBoundingClientRect();
      const { zoom } = stage.pen;
      const row = stage.rowAt((event.clientX - box.left) / zoom, (event.clientY - box.top) / zoom);
      rub.select(row ? row.id : -1);
    });
    measure();
  };

  /** Fit the stage to its place and its contact. */
  stage.fit = () => {
    stage.pen.fit();
    measure();
  };

  stage.placeOf = (row) => placeOf(row, [0, 0]);
  stage.measure = measure;
  stage.largest = largest;
  rub.stage = stage;
})();
