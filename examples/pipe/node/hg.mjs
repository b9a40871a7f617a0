// Henyey-Greenstein directions about +z.  fogproof check --exec "node hg.mjs" --spec ../hg.toml
import { serve } from "./fogproof.mjs";

const bug = process.argv.includes("--bug"); // wo points back to where the light came from

serve(["x", "x", "x", "pdf"], ({ parameters: { g = 0.8 } }) => {
  const pdf = (x) => (1 - g * g) / (4 * Math.PI * (1 + g * g - 2 * g * x[2]) ** 1.5);
  function sample(u, row) {
    const root = (1 - g * g) / (1 - g + 2 * g * u[0]);
    const mu = Math.abs(g) > 1e-3 ? (1 + g * g - root * root) / (2 * g) : 2 * u[0] - 1;
    const sine = Math.sqrt(Math.max(0, 1 - mu * mu));
    const phi = 2 * Math.PI * u[1];
    row.set([sine * Math.cos(phi), sine * Math.sin(phi), bug ? -mu : mu]);
    row[3] = pdf(row);
  }
  return { sample, pdf };
});
