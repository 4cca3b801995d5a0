// Colours that people tell apart however they see them (Okabe and Ito, Color Universal Design, 2008). Nothing is
// told by colour alone: robots have names, verdicts have marks and dashes.

// As in pictures of maps (server/output/pictures).
const OF_ROBOTS = [
  "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#550099", "#882200",
  "#6644ff", "#0000dd", "#776666", "#9977ee", "#22cc77", "#882266", "#cc1133", "#cc11aa",
];

export const OF_VERDICTS = { accepted: "#0072b2", waiting: "#b07500", refused: "#c03c00" };
export const DASHES = { accepted: [], waiting: [7, 4], refused: [2, 4] };
export const OF_ZONES = { keep_out: "#b3261e", speed: "#8a6d00" };
export const OF_CLOSURES = "#a3004f";
export const INK = "#1d252c";
export const OF_ORIGINS = ["#5b6770", "#5b6770", "#d55e00", "#0072b2", "#cc79a7", "#009e73"];

/** A robot's colour, by its place among names that keep their order: one that joins takes no other's. */
export function ofRobot(name, names) {
  const place = names.indexOf(name);
  return place < 0 ? INK : OF_ROBOTS[place % OF_ROBOTS.length];
}
