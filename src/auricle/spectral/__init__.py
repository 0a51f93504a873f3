"""The Fourier analysis of a surface: Laplacian, manifold harmonics, spectra."""
