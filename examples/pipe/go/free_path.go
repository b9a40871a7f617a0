// Free paths before a surface.  go build -o free_path free_path.go fogproof.go && fogproof check --exec ./free_path --spec ../free_path.toml
package main

import (
	"math"
	"os"
)

type freePath struct {
	sigmaT, surface float64
	bug             bool // --bug: at the surface the density is returned, not the probability
}

func (s freePath) Sample(u []float64, row []float64) {
	t := -math.Log1p(-u[0]) / s.sigmaT
	reached := t >= s.surface
	row[0], row[2] = math.Min(t, s.surface), 0
	row[1] = s.Pdf(row)
	if reached {
		row[2] = 1
	}
	if reached && !s.bug {
		row[1] = math.Exp(-s.sigmaT * s.surface)
	}
}

func (s freePath) Pdf(t []float64) float64 { return s.sigmaT * math.Exp(-s.sigmaT*t[0]) }

func main() {
	if Serve([]string{"x", "pdf", "event"}, func(r Request) Subject {
		return freePath{r.Get("sigma_t", 0.5), r.Get("surface", 3), len(os.Args) > 1}
	}) != nil {
		os.Exit(1)
	}
}
