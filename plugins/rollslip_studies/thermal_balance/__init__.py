"""Study thermal-balance: at which bulk temperatures losses and cooling of a bearing are in balance."""
