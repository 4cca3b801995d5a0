// Words of the server, as people say them.

/** Of a robot that explores, by the reason of its goal. */
export const OF_ORDERS = { frontier: "explores", wait: "waits for another", give_way: "gives way", finished: "has explored all",
  meet: "goes to meet another" };
