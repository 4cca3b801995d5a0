// Islands have frames of their own: they are shown side by side, in rows.

const GAP_M = 4;
/** An island's place changes only when it outgrows a whole number of these. */
const STEP_M = 8;

function roomy(box) {
  return [Math.floor(box[0] / STEP_M) * STEP_M, Math.floor(box[1] / STEP_M) * STEP_M,
    Math.ceil(box[2] / STEP_M) * STEP_M, Math.ceil(box[3] / STEP_M) * STEP_M];
}

/**
 * Where the origin of each island's frame is shown: offsets in metres by id, multiples of `unit_m`. The first
 * island stays where it is; rows fill from left to right and from the top.
 */
export function placeIslands(islands, unit_m) {
  const boxes = islands.map((island) => roomy(island.box));
  const area = boxes.reduce((sum, [x0, y0, x1, y1]) => sum + (x1 - x0 + GAP_M) * (y1 - y0 + GAP_M), 0);
  const rowWidth = Math.max(1.7 * Math.sqrt(area), ...boxes.map(([x0, , x1]) => x1 - x0));
  const offsets = new Map();
  const snapped = (metres) => Math.round(metres / unit_m) * unit_m;
  let [left, top] = boxes.length > 0 ? [boxes[0][0], boxes[0][3]] : [0, 0];
  const begin = left;
  let rowHeight = 0;
  islands.forEach((island, i) => {
    const [x0, y0, x1, y1] = boxes[i];
    if (left > begin && left - begin + x1 - x0 > rowWidth) {
      left = begin;
      top -= rowHeight + GAP_M;
      rowHeight = 0;
    }
    offsets.set(island.id, [snapped(left - x0), snapped(top - y1)]);
    left += x1 - x0 + GAP_M;
    rowHeight = Math.max(rowHeight, y1 - y0);
  });
  return offsets;
}

/** The box around all islands as they are placed: [x0, y0, x1, y1] in metres; null where there is none. */
export function extent(islands, offsets) {
  if (islands.length === 0) return null;
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const island of islands) {
    const [dx, dy] = offsets.get(island.id);
    box[0] = Math.min(box[0], island.box[0] + dx);
    box[1] = Math.min(box[1], island.box[1] + dy);
    box[2] = Math.max(box[2], island.box[2] + dx);
    box[3] = Math.max(box[3], island.box[3] + dy);
  }
  return box;
}
