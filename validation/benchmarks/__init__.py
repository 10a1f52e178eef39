"""Programs that measure speed and accuracy as ratios within one run."""
