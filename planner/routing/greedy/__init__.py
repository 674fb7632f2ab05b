"""The choices of Li, Chen, Wang, Li (2018), one after the other."""
