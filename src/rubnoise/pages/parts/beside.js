/* Two runs side by side: a window that moves in one frame moves in the other, and curves of a name have one axis. */
window.moved = (mover, from, to) => {
  for (const frame of document.querySelectorAll("iframe"))
    if (frame.contentWindow !== mover) frame.contentWindow.follow?.(from, to);
};
const limits = {};
window.shared = (owner, name, range) => {
  const known = (limits[name] ??= new Map());
  const isNew = String(known.get(owner)) !== String(range);
  known.set(owner, range);
  for (const { contentWindow: other } of isNew ? document.querySelectorAll("iframe") : [])
    if (other !== owner) setTimeout(() => other.redraw?.());
  const [low, high] = [[...known.values()].map((each) => each[0]), [...known.values()].map((each) => each[1])];
  return [Math.min(...low), Math.max(...high)];
};
