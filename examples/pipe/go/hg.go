// Henyey-Greenstein directions about +z.  go build -o hg hg.go fogproof.go && fogproof check --exec ./hg --spec ../hg.toml
package main

import (
	"math"
	"os"
)

type henyeyGreenstein struct {
	g   float64
	bug bool // --bug: wo points back to where the light came from
}

func (s henyeyGreenstein) Sample(u []float64, row []float64) {
	root := (1 - s.g*s.g) / (1 - s.g + 2*s.g*u[0])
	mu := (1 + s.g*s.g - root*root) / (2 * s.g)
	if math.Abs(s.g) < 1e-3 {
		mu = 2*u[0] - 1
	}
	sine, phi := math.Sqrt(math.Max(0, 1-mu*mu)), 2*math.Pi*u[1]
	if s.bug {
		mu = -mu
	}
	row[0], row[1], row[2] = sine*math.Cos(phi), sine*math.Sin(phi), mu
	row[3] = s.Pdf(row)
}

func (s henyeyGreenstein) Pdf(x []float64) float64 {
	return (1 - s.g*s.g) / (4 * math.Pi * math.Pow(1+s.g*s.g-2*s.g*x[2], 1.5))
}

func main() {
	if Serve([]string{"x", "x", "x", "pdf"}, func(r Request) Subject {
		return henyeyGreenstein{r.Get("g", 0.8), len(os.Args) > 1}
	}) != nil {
		os.Exit(1)
	}
}
