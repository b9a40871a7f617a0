// Ask the oracle from JavaScript: start `fogproof oracle -` once, write a request a line, read an answer a line.
// node oracle_client.mjs
import { spawn } from "node:child_process";
import { createInterface } from "node:readline";

class Oracle {
  constructor() {
    this.child = spawn("fogproof", ["oracle", "-"], { stdio: ["pipe", "pipe", "inherit"] });
    this.lines = createInterface({ input: this.child.stdout })[Symbol.asyncIterator]();
  }
  async ask(request) {
    this.child.stdin.write(JSON.stringify(request) + "\n");
    const answer = JSON.parse((await this.lines.next()).value);
    if (!("value" in answer)) throw new Error(`${answer.error.code}: ${answer.error.message}`);
    return answer; // {value, error, unit, convention, method, source}; infinite numbers are the strings "inf" and "-inf"
  }
  close() {
    this.child.stdin.end();
  }
}

const oracle = new Oracle();
const { value } = await oracle.ask({ quantity: "airlight_integral", sigma_t: 0.5, h: 1, a: -2, b: "inf" });
console.log(value);
oracle.close();
