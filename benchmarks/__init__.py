"""Speed, memory and quality of the way from theme to film, printed beside their limits: `python -m benchmarks`."""
