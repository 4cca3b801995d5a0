// An MCAP file by its index, checksums too, with MCAP's own reader: node read_mcap.mjs FILE
// Prints as JSON {topic: {schema, messages}}.
import { open } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";
import { decompress } from "fzstd";

const file = await open(process.argv[2]);
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, length) => {
    const bytes = new Uint8Array(Number(length));
    const { bytesRead } = await file.read(bytes, 0, bytes.length, Number(offset));
    return bytes.subarray(0, bytesRead);
  },
};
const reader = await McapIndexedReader.Initialize({
  readable,
  decompressHandlers: { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) },
});

const seen = {};
let newest = 0n;
for await (const message of reader.readMessages({ validateCrcs: true })) {
  if (message.logTime < newest) throw new Error("messages are not in the order of time");
  newest = message.logTime;
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  JSON.parse(new TextDecoder().decode(schema.data));
  JSON.parse(new TextDecoder().decode(message.data));
  seen[channel.topic] ??= { schema: schema.name, encoding: channel.messageEncoding, messages: 0 };
  seen[channel.topic].messages += 1;
}
const counted = Object.values(seen).reduce((sum, topic) => sum + topic.messages, 0);
if (BigInt(counted) !== reader.statistics.messageCount) throw new Error(`the file says other than its ${counted} messages`);
console.log(JSON.stringify(seen));
