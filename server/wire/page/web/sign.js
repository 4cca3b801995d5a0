// Signs an order as the server's README tells: an isthmus.signed_t that holds an isthmus.command_t, and HMAC-SHA-256
// over its bytes. Written out, as browsers offer theirs (SubtleCrypto) to this machine's pages and to HTTPS only.

const ROUND = new Uint32Array(64);
const START = new Uint32Array(8);
// FIPS 180-4, 4.2.2 and 5.3.3: fractions of the cube and square roots of the first primes.
for (let candidate = 2, count = 0; count < 64; ++candidate) {
  if ([...Array(candidate).keys()].slice(2).some((divisor) => candidate % divisor === 0)) continue;
  const fraction = (root) => (root - Math.floor(root)) * 2 ** 32;
  ROUND[count] = fraction(Math.cbrt(candidate));
  if (count < 8) START[count] = fraction(Math.sqrt(candidate));
  count += 1;
}

const turned = (word, bits) => (word >>> bits) | (word << (32 - bits));

function compress(state, view, at) {
  const w = new Uint32Array(64);
  for (let i = 0; i < 16; ++i) w[i] = view.getUint32(at + 4 * i);
  for (let i = 16; i < 64; ++i) {
    const s0 = turned(w[i - 15], 7) ^ turned(w[i - 15], 18) ^ (w[i - 15] >>> 3);
    const s1 = turned(w[i - 2], 17) ^ turned(w[i - 2], 19) ^ (w[i - 2] >>> 10);
    w[i] = w[i - 16] + s0 + w[i - 7] + s1;
  }
  let [a, b, c, d, e, f, g, h] = state;
  for (let i = 0; i < 64; ++i) {
    const s1 = turned(e, 6) ^ turned(e, 11) ^ turned(e, 25);
    const t1 = (h + s1 + ((e & f) ^ (~e & g)) + ROUND[i] + w[i]) | 0;
    const s0 = turned(a, 2) ^ turned(a, 13) ^ turned(a, 22);
    const t2 = (s0 + ((a & b) ^ (a & c) ^ (b & c))) | 0;
    [h, g, f, e, d, c, b, a] = [g, f, e, (d + t1) | 0, c, b, a, (t1 + t2) | 0];
  }
  [a, b, c, d, e, f, g, h].forEach((word, i) => { state[i] += word; });
}

/** SHA-256 (FIPS 180-4) of bytes. */
export function sha256(bytes) {
  const padded = new Uint8Array(Math.ceil((bytes.length + 9) / 64) * 64);
  padded.set(bytes);
  padded[bytes.length] = 0x80;
  const view = new DataView(padded.buffer);
  view.setBigUint64(padded.length - 8, BigInt(bytes.length) * 8n);
  const state = START.slice();
  for (let at = 0; at < padded.length; at += 64) compress(state, view, at);
  const digest = new DataView(new ArrayBuffer(32));
  state.forEach((word, i) => digest.setUint32(4 * i, word));
  return new Uint8Array(digest.buffer);
}

const joined = (...parts) => new Uint8Array(parts.flatMap((part) => [...part]));

/** HMAC-SHA-256 (RFC 2104) with a key of at most 64 bytes. */
export function hmac(key, bytes) {
  const padded = new Uint8Array(64);
  padded.set(key);
  const mixed = (value) => padded.map((byte) => byte ^ value);
  return sha256(joined(mixed(0x5c), sha256(joined(mixed(0x36), bytes))));
}

function int64(value) {
  const view = new DataView(new ArrayBuffer(8));
  view.setBigInt64(0, BigInt.asIntN(64, BigInt(value)));
  return new Uint8Array(view.buffer);
}

function int32(value) {
  const view = new DataView(new ArrayBuffer(4));
  view.setInt32(0, value);
  return new Uint8Array(view.buffer);
}

/** A string as LCM has it: its length with the zero behind it, then both. */
function text(value) {
  const bytes = new TextEncoder().encode(value);
  return joined(int32(bytes.length + 1), bytes, [0]);
}

/** 64 hexadecimal digits as 32 bytes; null for anything else. */
export function keyOf(digits) {
  if (!/^[0-9a-fA-F]{64}$/.test(digits)) return null;
  return new Uint8Array(digits.match(/../g).map((pair) => parseInt(pair, 16)));
}

function double(value) {
  const view = new DataView(new ArrayBuffer(8));
  view.setFloat64(0, value);
  return new Uint8Array(view.buffer);
}

const KINDS_OF_ANNOTATIONS = ["place", "keep_out", "speed", "erase"];

/** The channel of an order, and its message: an annotation_t, an initial_pose_t or a command_t. */
function messageOf(order, utime, types) {
  if (KINDS_OF_ANNOTATIONS.includes(order.verb)) {
    const points = order.points ?? [];
    return ["ISTHMUS_ANNOTATION", joined(int64("0x" + types.annotation), int64(utime), text(order.verb), text(order.name),
      [order.replace ? 1 : 0], double(order.max_speed ?? 0), int32(-1), double(order.yaw ?? 0), int32(points.length),
      ...points.map(([patch, x, y]) => joined(int32(patch), double(x), double(y))))];
  }
  if (order.verb === "initial_pose") {
    return [`${order.robot}_INITIAL_POSE`, joined(int64("0x" + types.initial_pose), int64(utime), int32(-1), int32(order.patch),
      ...order.pose.map(double), double(order.sigma_m), double(order.sigma_rad))];
  }
  return ["ISTHMUS_COMMAND", joined(int64("0x" + types.command), int64(utime), text(order.verb), int64(order.closure ?? -1),
    text(order.robot ?? ""))];
}

/**
 * The bytes of a signed order. `types`: the fingerprints of LCM's types, as hexadecimal text. `utime`:
 * microseconds, more than that of the operator's last order.
 */
export function signedOrder(order, operator, key, utime, types) {
  const [channel, bytes] = messageOf(order, utime, types);
  const envelope = joined(int64("0x" + types.signed), text(channel), text(operator), int64(utime),
    int32(bytes.length), bytes);
  return joined(envelope, hmac(key, envelope));
}
