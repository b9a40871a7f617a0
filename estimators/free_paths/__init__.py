"""Free paths and transmittance where the optical depth has a closed form."""
