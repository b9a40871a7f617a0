// Let fogproof judge a Go sampler or estimator over a pipe: one file beside yours. The protocol is docs/pipe.md.
package main

import (
	"bufio"
	"encoding/binary"
	"encoding/json"
	"fmt"
	"io"
	"math"
	"os"
)

// Request is the line before a block of N rows of Columns numbers.
type Request struct {
	Request    string             `json:"request"`
	N          int                `json:"n"`
	Columns    int                `json:"columns"`
	Seed       uint64             `json:"seed"`
	Parameters map[string]float64 `json:"parameters"`
}

// Get returns a parameter by its name, or otherwise if it is not there.
func (r Request) Get(name string, otherwise float64) float64 {
	if value, there := r.Parameters[name]; there {
		return value
	}
	return otherwise
}

// Subject is what is judged: one row of uniforms to the columns that are announced, and the density at a point.
type Subject interface {
	Sample(u []float64, row []float64)
	Pdf(x []float64) float64
}

// Serve answers requests until the input ends.
func Serve(columns []string, make_ func(Request) Subject) error {
	input, output := bufio.NewReaderSize(os.Stdin, 1<<20), bufio.NewWriterSize(os.Stdout, 1<<20)
	names, _ := json.Marshal(columns)
	fmt.Fprintf(output, "{\"fogproof\": 1, \"type\": \"float64\", \"columns\": %s, \"answers\": [\"pdf\"]}\n", names)
	output.Flush()
	for {
		line, err := input.ReadBytes('\n')
		if err == io.EOF {
			return nil
		}
		var r Request
		if err := json.Unmarshal(line, &r); err != nil {
			return err
		}
		in := make([]byte, 8*r.N*r.Columns)
		if _, err := io.ReadFull(input, in); err != nil {
			return err
		}
		width := len(columns)
		if r.Request == "pdf" {
			width = 1
		}
		u, row, out := make([]float64, r.Columns), make([]float64, width), make([]byte, 0, 8*r.N*width)
		subject := make_(r)
		for i := 0; i < r.N; i++ {
			for j := range u {
				u[j] = math.Float64frombits(binary.LittleEndian.Uint64(in[8*(i*r.Columns+j):]))
			}
			if r.Request == "pdf" {
				row[0] = subject.Pdf(u)
			} else {
				subject.Sample(u, row)
			}
			for _, value := range row {
				out = binary.LittleEndian.AppendUint64(out, math.Float64bits(value))
			}
		}
		fmt.Fprintf(output, "{\"n\": %d}\n", r.N)
		output.Write(out)
		if err := output.Flush(); err != nil {
			return err
		}
	}
}
