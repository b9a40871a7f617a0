// Ask the oracle from Rust: start `fogproof oracle -` once, write a request a line, read an answer a line.
// rustc -O oracle_client.rs && ./oracle_client
use std::io::{BufRead, BufReader, Write};
use std::process::{ChildStdin, ChildStdout, Command, Stdio};

struct Oracle { to: ChildStdin, from: BufReader<ChildStdout> }

impl Oracle {
    fn start() -> std::io::Result<Oracle> {
        let mut child = Command::new("fogproof").args(["oracle", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        Ok(Oracle { to: child.stdin.take().unwrap(), from: BufReader::new(child.stdout.take().unwrap()) })
    }
    fn ask(&mut self, request: &str) -> std::io::Result<String> {
        writeln!(self.to, "{request}")?;
        let mut line = String::new(); // {"protocol": ..., "value": 0.505, "error": 3e-15, ...} or {..., "error": {"code": ...}}
        self.from.read_line(&mut line)?;
        Ok(line)
    }
}

fn main() -> std::io::Result<()> {
    let line = Oracle::start()?.ask(r#"{"quantity": "airlight_integral", "sigma_t": 0.5, "h": 1, "a": -2, "b": "inf"}"#)?;
    let rest = line.split_once("\"value\": ").expect(&line).1;
    let value: f64 = rest[..rest.find(',').unwrap()].parse().unwrap();
    println!("{value:?}");
    Ok(())
}
