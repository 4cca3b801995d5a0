// Words of the server, as people say them.

/** Of a robot that explores, by the reason of its goal. */
export const OF_ORDERS = { frontier: "explores", wait: "waits for another", give_way: "gives way", finished: "has explored all",
  meet: "goes to meet another" };

/** Of closures, where the server's own words say too little. */
const OF_REASONS = { map_changed: "the map has changed since: it is tried again on the map as it is",
  rested_on_another: "what it rested on has been withdrawn", too_little_support: "too little speaks for it as yet",
  forbidden: "forbidden by an operator", allowed_again: "allowed again" };

export const ofReason = (reason) => OF_REASONS[reason] ?? reason.replaceAll("_", " ");

export const counted = (number, one, many = `${one}s`) => `${number} ${number === 1 ? one : many}`;
