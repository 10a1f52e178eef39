"""The evidence behind the numbers: accuracy, speed, extremes and comparisons, each as a program that anyone can run."""
