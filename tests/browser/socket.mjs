// The page and its frames, without a browser: what goes through a socket that was handed in.
import { createHash, randomBytes } from "node:crypto";
import { request } from "node:http";

const url = new URL(process.env.RGBDT_URL);
const kPatienceMs = 20_000;

function fail(why) {
  console.error(why);
  process.exit(1);
}

/// Its payload as soon as all of it is there, and what follows.
function firstMessage(bytes) {
  if (bytes.length < 2) return null;
  const short = bytes[1] & 127;
  const at = { 126: 4, 127: 10 }[short] ?? 2;
  if (bytes.length < at) return null;
  const size = at === 2 ? short : at === 4 ? bytes.readUInt16BE(2) : Number(bytes.readBigUInt64BE(2));
  return bytes.length < at + size ? null : { payload: bytes.subarray(at, at + size), rest: bytes.subarray(at + size) };
}

/// A text message as a client sends it: masked.
function textMessage(text) {
  const data = Buffer.from(text), mask = randomBytes(4);
  if (data.length > 125) throw new Error("a longer message has another header");
  return Buffer.concat([Buffer.from([0x81, 0x80 | data.length]), mask, data.map((byte, i) => byte ^ mask[i % 4])]);
}

/// Calls `onHeader` with the header of each binary frame.
function listen(onHeader) {
  const key = randomBytes(16).toString("base64");
  const asked = request({ host: url.hostname, port: url.port, path: "/ws", headers: {
    Connection: "Upgrade", Upgrade: "websocket", "Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": key, Origin: url.origin,
  } });
  asked.on("upgrade", (answer, socket, head) => {
    const wanted = createHash("sha1").update(`${key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest("base64");
    if (answer.headers["sec-websocket-accept"] !== wanted) fail("not a WebSocket");
    let bytes = head;
    socket.on("data", (more) => {
      bytes = Buffer.concat([bytes, more]);
      for (let next = firstMessage(bytes); next; next = firstMessage(bytes)) {
        bytes = next.rest;
        onHeader(JSON.parse(next.payload.subarray(8, 8 + next.payload.readUInt32LE(4)).toString()));
      }
    });
    socket.on("close", () => fail("the bridge closed the connection"));
    socket.write(textMessage(JSON.stringify({ type: "hello", token: "" })));
  });
  asked.on("response", (answer) => fail(`no WebSocket: ${answer.statusCode}`));
  asked.on("error", (error) => fail(`no WebSocket: ${error}`));
  asked.end();
}

const page = await fetch(url);
const text = await page.text();
if (page.status !== 200 || !/<script/.test(text)) fail(`no page: ${page.status}`);
setTimeout(() => fail("no message of the inner bus came"), kPatienceMs);
listen((header) => {
  if (header.type !== "bus" || !header.processes.some(({ process: name }) => name === "detector")) return;
  console.log(`a page of ${text.length} characters, and what rgbdt-detector says on the inner bus`);
  process.exit(0);
});
