// Foxglove's own client on a live server, until each topic has sent something: node watch.mjs PORT TOPIC...
// Prints as JSON {topic: {schema, messages}}.
import protocol from "@foxglove/ws-protocol";
import WebSocket from "ws";

const [port, ...topics] = process.argv.slice(2);
const limitMs = 60_000;
const { FoxgloveClient } = protocol;

function fail(reason) {
  console.error(reason);
  process.exit(1);
}

const seen = {};
const topicOf = new Map();
const client = new FoxgloveClient({
  ws: new WebSocket(`ws://127.0.0.1:${port}`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]),
});
client.on("error", (error) => fail(`error: ${error.message}`));
client.on("status", (status) => fail(`status: ${status.message}`));
client.on("close", () => fail("the server closed the stream"));
client.on("advertise", (channels) => {
  for (const channel of channels) {
    JSON.parse(channel.schema);
    topicOf.set(client.subscribe(channel.id), channel.topic);
    seen[channel.topic] ??= { schema: channel.schemaName, encoding: channel.encoding, messages: 0 };
  }
});
client.on("message", ({ subscriptionId, data }) => {
  JSON.parse(new TextDecoder().decode(data));
  seen[topicOf.get(subscriptionId)].messages += 1;
  if (topics.every((topic) => seen[topic]?.messages > 0)) {
    console.log(JSON.stringify(seen));
    process.exit(0);
  }
});
setTimeout(() => fail(`nothing came of ${topics.filter((topic) => !(seen[topic]?.messages > 0))}`), limitMs);
