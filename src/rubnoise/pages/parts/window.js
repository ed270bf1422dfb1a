/* How the window moves: by dragging it over the overview, by the wheel, and back by undo. */
const { data } = view;
const $ = (id) => document.getElementById(id);
const shortest = Math.max(data.tick, 1e-9 * data.distance);
const MOST_STEPS = 100;
/* Turns of the wheel, and moves of the pointer, that follow each other as fast as this in ms are one step to undo. */
const SOON = 400;
const past = [];
let lately = -Infinity;

view.show = (from, to, smoothly = false) => {
  const width = Math.min(Math.max(to - from, shortest), data.distance);
  const begin = Math.min(Math.max(from, 0), data.distance - width);
  const { from: before, to: behind } = view.window;
  if (before === begin && behind === begin + width) return view.render();
  const now = performance.now();
  if (now - lately > SOON) past.push({ from: before, to: behind });
  if (past.length > MOST_STEPS) past.shift();
  lately = smoothly ? now : -Infinity;
  view.window = { from: begin, to: begin + width };
  view.render();
};

view.undo = () => {
  if (!past.length) return;
  view.window = past.pop();
  lately = -Infinity;
  view.render();
};
view.canUndo = () => past.length > 0;

view.zoom = (factor, around = (view.window.from + view.window.to) / 2, smoothly = false) => {
  const { from, to } = view.window;
  view.show(around - factor * (around - from), around + factor * (to - around), smoothly);
};
view.move = (part) => {
  const { from, to } = view.window;
  view.show(from + part * (to - from), to + part * (to - from));
};

/** As on a map in a page: with Ctrl the wheel zooms; without it the page scrolls, and says so the first time. */
let told = false;
view.zoomsByWheel = (chart, distanceOf) => {
  chart.over.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.shiftKey && !event.metaKey) {
      if (!told) $("wheel").hidden = false;
      told = true;
      setTimeout(() => { $("wheel").hidden = true; }, 4000);
      return;
    }
    event.preventDefault();
    const value = chart.posToVal(event.clientX - chart.over.getBoundingClientRect().left, "x");
    view.zoom(event.deltaY + event.deltaX > 0 ? 1.5 : 1 / 1.5, distanceOf(value), true);
  }, { passive: false });
};

/** Dragging over the overview moves the window; a press beside it brings it there. */
view.movesWindow = ({ over, posToVal }) => {
  let grip = 0;
  const at = (event) => posToVal(event.clientX - over.getBoundingClientRect().left, "x");
  const to = (middle) => {
    const half = 0.5 * (view.window.to - view.window.from);
    view.show(middle - half, middle + half, true);
  };
  const take = (event) => {
    const s = at(event);
    const { from, to: end } = view.window;
    if (s < from || s > end) to(s);
    grip = s - 0.5 * (view.window.from + view.window.to);
  };
  rub.dragging(over, take, (event) => to(at(event) - grip));
};
