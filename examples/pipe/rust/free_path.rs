// Free paths before a surface.  rustc -O --edition 2021 free_path.rs && fogproof check --exec ./free_path --spec ../free_path.toml
mod fogproof;

struct FreePath {
    sigma_t: f64,
    surface: f64,
    bug: bool, // --bug: at the surface the density is returned, not the probability
}

impl fogproof::Subject for FreePath {
    fn sample(&self, u: &[f64], row: &mut [f64]) {
        let t = -(-u[0]).ln_1p() / self.sigma_t;
        let reached = t >= self.surface;
        row[0] = t.min(self.surface);
        row[1] = if reached && !self.bug { (-self.sigma_t * self.surface).exp() } else { self.pdf(&row[..1]) };
        row[2] = if reached { 1.0 } else { 0.0 };
    }
    fn pdf(&self, t: &[f64]) -> f64 {
        self.sigma_t * (-self.sigma_t * t[0]).exp()
    }
}

fn main() -> std::io::Result<()> {
    let bug = std::env::args().count() > 1;
    fogproof::serve(&["x", "pdf", "event"], |p| FreePath {
        sigma_t: p.get("sigma_t", 0.5),
        surface: p.get("surface", 3.0),
        bug,
    })
}
