"""What accuracy costs: stages and contact models measured against converged solutions over random designs."""
