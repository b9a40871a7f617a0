// Free paths before a surface.  fogproof check --exec "node free_path.mjs" --spec ../free_path.toml
import { serve } from "./fogproof.mjs";

const bug = process.argv.includes("--bug"); // at the surface the density is returned, not the probability

serve(["x", "pdf", "event"], ({ parameters: { sigma_t = 0.5, surface = 3 } }) => {
  const pdf = (t) => sigma_t * Math.exp(-sigma_t * t[0]);
  function sample(u, row) {
    const t = -Math.log1p(-u[0]) / sigma_t;
    const reached = t >= surface;
    row[0] = reached ? surface : t;
    row[1] = reached && !bug ? Math.exp(-sigma_t * surface) : pdf(row);
    row[2] = reached ? 1 : 0;
  }
  return { sample, pdf };
});
