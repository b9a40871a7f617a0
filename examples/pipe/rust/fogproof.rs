// Let fogproof judge a Rust sampler or estimator over a pipe: one module, no crates. The protocol is docs/pipe.md.
use std::io::{self, BufRead, Read, Write};

/// What stands in the line of a request, such as {"fogproof": 1, "request": "sample", "n": 4096, "parameters": {"g": 0.8}}.
pub struct Parameters(String);

impl Parameters {
    /// A number by its name, or `otherwise` if it is not there.
    pub fn get(&self, name: &str, otherwise: f64) -> f64 {
        let key = format!("\"{name}\": ");
        let Some(at) = self.0.find(&key) else { return otherwise };
        let rest = &self.0[at + key.len()..];
        rest[..rest.find([',', '}']).unwrap_or(rest.len())].trim().parse().unwrap_or(otherwise)
    }
    fn asks(&self, request: &str) -> bool {
        self.0.contains(&format!("\"request\": \"{request}\""))
    }
}

pub trait Subject {
    /// One row of uniforms to the columns that are announced.
    fn sample(&self, u: &[f64], row: &mut [f64]);
    /// The density at a point.
    fn pdf(&self, x: &[f64]) -> f64;
}

/// Answer requests until the input ends.
pub fn serve<S: Subject>(columns: &[&str], make: impl Fn(&Parameters) -> S) -> io::Result<()> {
    let (mut input, mut output) = (io::stdin().lock(), io::stdout().lock());
    let names: Vec<String> = columns.iter().map(|name| format!("\"{name}\"")).collect();
    let names = names.join(", ");
    writeln!(output, r#"{{"fogproof": 1, "type": "float64", "columns": [{names}], "answers": ["pdf"]}}"#)?;
    output.flush()?;
    loop {
        let mut line = String::new();
        if input.read_line(&mut line)? == 0 {
            return Ok(());
        }
        let parameters = Parameters(line);
        let (n, k) = (parameters.get("n", 0.0) as usize, parameters.get("columns", 0.0) as usize);
        let mut bytes = vec![0u8; 8 * n * k];
        input.read_exact(&mut bytes)?;
        let rows: Vec<f64> = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
        let subject = make(&parameters);
        let width = if parameters.asks("pdf") { 1 } else { columns.len() };
        let mut out = vec![0f64; n * width];
        for i in 0..n {
            let row = &rows[i * k..(i + 1) * k];
            if parameters.asks("pdf") {
                out[i] = subject.pdf(row);
            } else {
                subject.sample(row, &mut out[i * width..(i + 1) * width]);
            }
        }
        writeln!(output, "{{\"n\": {n}}}")?;
        output.write_all(&out.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>())?;
        output.flush()?;
    }
}
