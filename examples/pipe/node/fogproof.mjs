// Let fogproof judge a JavaScript sampler or estimator over a pipe: one module. The protocol is docs/pipe.md.
// columns: the names of a row; make(request) returns { sample(u, row), pdf(x) }, where request.parameters are those of the spec.
import { readSync, writeSync } from "node:fs";

function writeAll(bytes) {
  for (let at = 0; at < bytes.length; ) {
    try {
      at += writeSync(1, bytes, at);
    } catch (error) {
      if (error.code !== "EAGAIN") throw error;
    }
  }
}

let held = Buffer.alloc(0);
function more() {
  const chunk = Buffer.alloc(1 << 20);
  for (;;) {
    try {
      const n = readSync(0, chunk);
      if (n > 0) held = Buffer.concat([held, chunk.subarray(0, n)]);
      return n > 0;
    } catch (error) {
      if (error.code === "EOF") return false;
      if (error.code !== "EAGAIN") throw error;
    }
  }
}
function take(n) {
  while (held.length < n) if (!more()) process.exit(1);
  const bytes = Buffer.from(held.subarray(0, n)); // a copy, so that 8-byte numbers are aligned
  held = held.subarray(n);
  return bytes;
}

export function serve(columns, make) {
  writeAll(Buffer.from(JSON.stringify({ fogproof: 1, type: "float64", columns, answers: ["pdf"] }) + "\n"));
  for (;;) {
    let end;
    while ((end = held.indexOf(10)) < 0) if (!more()) return;
    const request = JSON.parse(take(end + 1).toString());
    const { n, columns: k } = request;
    const bytes = take(8 * n * k);
    const rows = new Float64Array(new Uint8Array(bytes).buffer);
    const width = request.request === "pdf" ? 1 : columns.length;
    const out = new Float64Array(n * width);
    const subject = make(request);
    for (let i = 0; i < n; i++) {
      const row = rows.subarray(i * k, (i + 1) * k);
      if (request.request === "pdf") out[i] = subject.pdf(row);
      else subject.sample(row, out.subarray(i * width, (i + 1) * width));
    }
    writeAll(Buffer.from(`{"n": ${n}}\n`));
    writeAll(Buffer.from(out.buffer));
  }
}
