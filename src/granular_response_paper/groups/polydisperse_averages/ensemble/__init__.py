"""How an ensemble of polydisperse slabs is made and averaged."""
