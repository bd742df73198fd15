"""How well short scripts are found and woven, held against labels that were written by hand."""
